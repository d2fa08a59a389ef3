// SPDX-License-Identifier: GPL-3.0-or-later
// Attempts made of numbers alone, to write recordings without a simulation.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "recorder/base/identity.h"
#include "recorder/engine/observer.h"
#include "sim/math/random.h"

namespace calot::recorder::test {

/// PCG32 needs no library.
using calot::Random;

/// A folder of its own under the system's temporary folder, removed at the end.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// A header with every field set.
AttemptHeader makeHeader(std::uint32_t ticksPerStep = 10, std::size_t organs = 2);

/// The same with vessels, bodies of fat and a procedure (all of it since version 3 of StepResult).
AttemptHeader withStructures(AttemptHeader header, std::size_t vessels, std::size_t fat);

/// One step with its own storage.
struct Step {
  std::vector<TickSamples> samples;
  std::vector<TickOutcome> ticks;
  StepResult result;
  StateDigest digest;
  float lateness = 0.0F;
};

/// Steps whose every value is random: bits that any mistake of place, order or width would change.
Step randomStep(const AttemptHeader& header, std::uint64_t n, std::uint64_t seed);

/// Steps like those of a real run: smooth motion on the samples' grid, contact a third of the time, forces on a grid of
/// 2^-14 N, organs that follow.
Step plausibleStep(const AttemptHeader& header, std::uint64_t n);

/// A keyframe of the given size, smooth numbers in most of it.
Keyframe makeKeyframe(std::uint64_t step, std::size_t bytes);

/// Feeds steps [0, count) to an observer.
void feed(Observer& observer, const AttemptHeader& header, std::uint64_t count,
          const std::function<Step(std::uint64_t)>& make, std::size_t keyframeBytes);

/// Writes a whole recording and closes it.
void writeRecording(const std::filesystem::path& path, const AttemptHeader& header, std::uint64_t steps,
                    std::uint64_t seed = 1, std::size_t keyframeBytes = 3001);

}  // namespace calot::recorder::test
