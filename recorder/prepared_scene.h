// SPDX-License-Identifier: GPL-3.0-or-later
// What all runs of a scene share, worked out once: its Model, and compliances as they come to be needed.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recorder/base/errors.h"
#include "recorder/base/identity.h"
#include "recorder/compliance_cache.h"
#include "recorder/recording/reader.h"
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

/// Where scenes that are prepared from now on find compliances and save them; none, as at first: nowhere.
void useComplianceCache(const std::optional<std::filesystem::path>& folder);

}  // namespace calot::recorder
