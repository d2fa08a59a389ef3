// SPDX-License-Identifier: GPL-3.0-or-later
// Input of external metrics: a folder of arrays (schemas/metric-input.md).
#pragma once

#include <filesystem>
#include <utility>

#include "analytics/checkpoints/definition.h"
#include "analytics/external/input_columns.h"
#include "recorder/base/identity.h"
#include "recorder/engine/observer.h"
#include "recorder/sources/tracked_motion.h"
#include "sim/judgement/judge.h"

namespace calot::analytics {

/// A new folder that its owner alone may enter, removed with all that is in it.
class TemporaryFolder {
 public:
  /// Below TMPDIR. @throws Error (failure).
  TemporaryFolder();
  TemporaryFolder(TemporaryFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;
  ~TemporaryFolder();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// The observer that writes them: results once a step, samples and forces once a tick, events as they are judged. It
/// says nothing of who acted: a metric can't go by participant or group.
class MetricInput final : public recorder::Observer {
 public:
  /// @param scene the attempt's own. @param origin `resimulated` or `observables`. @throws Error (failure), as all
  /// functions here, where the folder cannot be written
  MetricInput(const recorder::AttemptHeader& header, const SceneDescription& scene, Origin origin);

  void onStep(const recorder::StepRecord& record) override;
  void onEnd(recorder::Outcome outcome) override;

  /// The folder, complete. @pre onEnd() was called
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_.path(); }

 private:
  TemporaryFolder folder_;
  recorder::AttemptHeader header_;
  Judge judge_;
  InputColumns results_, samples_, events_;
  Origin origin_;
};

/// The same of motion without a scene: its rows are the samples.
/// @param outcome as declared. @param handedness "right", "left", "unknown"
TemporaryFolder writeMetricInput(const recorder::TrackedMotion& motion, recorder::Outcome outcome,
                                 const std::string& handedness, const std::string& task);

}  // namespace calot::analytics
