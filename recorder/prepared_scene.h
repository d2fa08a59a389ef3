// SPDX-License-Identifier: GPL-3.0-or-later
// What runs of a scene share: its Model, and compliances as they are needed; and the choice of the engine that decides
// a recording of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recorder/base/errors.h"
#include "recorder/base/identity.h"
#include "recorder/compliance_cache.h"
#include "recorder/engine/engine.h"
#include "recorder/recording/reader.h"
#include "sim/math/executor.h"
#include "sim/scene/model.h"
#include "sim/step/stepper.h"

namespace calot::recorder {

/// May be used by several threads at the same time.
class PreparedScene {
 public:
  /// @param assets as AttemptHeader has them @throws Error (damaged) at `where` if no Model can be built of them
  PreparedScene(const std::vector<Asset>& assets, const Where& where);

  [[nodiscard]] const Model& model() const { return *model_; }
  [[nodiscard]] SharedCompliances& compliances() { return compliances_; }
  /// For sessions of the scene. @param makeBroadPhase as in StepperServices
  [[nodiscard]] StepperServices services(MakeBroadPhase makeBroadPhase = nullptr) {
    return {&compliances_, makeBroadPhase};
  }

  /// Puts what was worked out into the user's cache folder if a good part of it is new: after a run. Where that cannot
  /// be written, nothing happens.
  void save();

 private:
  std::string key_, name_;
  std::unique_ptr<const Model> model_;
  SharedCompliances compliances_;
  std::mutex saving_;
  std::size_t saved_ = 0;  ///< of those computed
};

/// The scene of these assets: one that this process has at hand, or a new one. The few that were asked for last are
/// kept; where several threads ask for the same, one builds it. @throws as PreparedScene
std::shared_ptr<PreparedScene> prepareScene(const std::vector<Asset>& assets, const Where& where);

/// That of a recording. @throws Error (damaged) where the scene in it cannot be built.
std::shared_ptr<PreparedScene> sceneOf(const Recording& recording);

/// Folder in which scenes prepared from now on find and save compliances; none, as at first: no cache.
void useComplianceCache(const std::optional<std::filesystem::path>& folder);

/// Request for an engine. Default: the one of the recording's version, in this program where it is its own.
struct EngineRequest {
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
  EngineChoice(const Recording& recording, const EngineRequest& request);

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
  std::uint32_t version_ = 0;         ///< of that program
  std::vector<std::string> command_;  ///< that starts it
};

}  // namespace calot::recorder
