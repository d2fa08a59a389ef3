// SPDX-License-Identifier: GPL-3.0-or-later
// Choice of the engine that decides a recording.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recorder/base/errors.h"
#include "recorder/engine/engine.h"
#include "recorder/prepared_scene.h"
#include "recorder/recording/reader.h"
#include "sim/math/executor.h"

namespace calot::recorder {

/// Request for an engine. Default: the one of the recording's version, in this program where it is its own.
struct EngineWish {
  bool apart = false;               ///< as a program of its own, confined: for recordings that are not trusted
  bool anyway = false;              ///< this program's own, whatever the recording's version
  std::filesystem::path file = {};  ///< this program or module, which must be of the recording's version
  /// Broad phase of this program's own simulation; null, as in every other program: SortedGrid.
  MakeBroadPhase makeBroadPhase = nullptr;
};

/// The engine of a recording's simulation version: this program's own, or a kept one. Makes any number of it.
class EngineChoice {
 public:
  /// @throws Error (undecided) where no engine of that version is here; (damaged) where the scene cannot be built;
  /// (failure) where this version is to be decided apart and there is no calot-engine
  EngineChoice(const Recording& recording, const EngineWish& wish);

  /// A new engine with the recording's scene. @param executor outlives it @throws as EngineProcess
  [[nodiscard]] std::unique_ptr<Engine> make(Executor& executor) const;
  /// Is it this program's own simulation, in this program?
  [[nodiscard]] bool isInside() const { return scene_ != nullptr; }
  /// Has the engine the digests of that layout? Another program is asked when it is made, which throws.
  [[nodiscard]] bool fits(const DigestLayout& layout) const;
  /// nameFault() of the recording; empty for another version, and of another program, which is asked when it is made.
  [[nodiscard]] std::string nameFault() const;
  /// The recording's scene. @throws Error (damaged) where it cannot be read by this program
  [[nodiscard]] const SceneDescription& scene() const;
  /// To be called after a run: keeps what the scene's runs share (PreparedScene::save()).
  void save() const;

 private:
  const AttemptHeader& header_;
  Where where_;
  std::shared_ptr<PreparedScene> scene_;                 ///< null: another program
  mutable std::optional<SceneDescription> description_;  ///< then, once asked for
  MakeBroadPhase makeBroadPhase_;
  std::vector<std::string> command_;
  std::uint32_t version_ = 0;  ///< of that program
};

}  // namespace calot::recorder
