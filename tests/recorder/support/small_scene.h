// SPDX-License-Identifier: GPL-3.0-or-later
// touch-liver with coarse organs, and sources that do what a test wants.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "recorder/engine/observer.h"
#include "recorder/formats/scene_file.h"
#include "recorder/sources/source.h"
#include "sim/scene/model.h"

namespace calot::recorder::test {

struct SmallScene {
  std::vector<Asset> assets;
  std::unique_ptr<const Model> model;
};

/// The scene's organs with about 300 tetrahedra each.
SmallScene smallScene();

/// A synthetic operator from its tick `begin` on. By 2700 both hands are on their way to their first touch, which comes
/// half a second later.
std::unique_ptr<SampleSource> performer(const SmallScene& scene, const std::string& profile, std::uint64_t seed,
                                        std::uint64_t begin = 2700);

/// A folder that goes away.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// A slow machine: after a step, keeps the simulation's thread for as long as `wait` takes.
class SlowMachine final : public Observer {
 public:
  explicit SlowMachine(std::function<void(std::uint64_t step)> wait) : wait_(std::move(wait)) {}
  void onStep(const StepRecord& record) override { wait_(record.step); }
  void onEnd(Outcome /*outcome*/) override {}

 private:
  std::function<void(std::uint64_t)> wait_;
};

}  // namespace calot::recorder::test
