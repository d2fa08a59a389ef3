// SPDX-License-Identifier: GPL-3.0-or-later
// Values of all checkpoints: of a run or replay, of recorded observables, or of motion alone.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/motion.h"
#include "recorder/engine/observer.h"
#include "recorder/recording/reader.h"
#include "recorder/sources/tracked_motion.h"

namespace calot::analytics {

/// The observer that feeds every checkpoint of the registry. Attach it to a live run, to a replay, or to a reader of
/// observables; the same steps give the same values, bit for bit.
class CheckpointCollector final : public recorder::Observer {
 public:
  /// @param scene the attempt's own: the Model's, or recorder::sceneFromAssets() of the recording's assets.
  /// @param origin what the StepRecords are: `resimulated` (live or replay) or `observables` (read from the file).
  /// @param cutoff of the motion filter (Hz), one of motionCutoffs. Values that are stored are of the default.
  CheckpointCollector(const recorder::AttemptHeader& header, const SceneDescription& scene,
                      Origin origin = Origin::resimulated, double cutoff = 6.0);
  ~CheckpointCollector() override;
  CheckpointCollector(const CheckpointCollector&) = delete;
  CheckpointCollector& operator=(const CheckpointCollector&) = delete;

  void onStep(const recorder::StepRecord& record) override;
  /// The same with what somebody else judged of the step: of a run, take either this or onStep().
  void take(const recorder::StepRecord& record, const Judgement& judgement);
  void onEnd(recorder::Outcome outcome) override;

  /// Every figure in the registry's order, subjects in the order of hands or organs. After onEnd() they are final;
  /// before, those whose definition says `final` are provisional.
  [[nodiscard]] std::vector<CheckpointValue> values() const;

 private:
  struct Storage;
  std::unique_ptr<Storage> storage_;
};

/// Every figure of a recording from what its steps recorded of themselves, without simulating: for recordings of other
/// simulation versions, whose results any later software can read. Origins are `observables` and `samples`.
/// @param cutoff of the motion filter (Hz); values that are stored are of the default.
/// @param also sees the same steps, and the end; or null.
/// @pre the recording's content chain was found intact.
/// @throws Error (damaged) where the file cannot be read, or its results do not fit its scene.
std::vector<CheckpointValue> valuesFromObservables(recorder::Recording& recording, double cutoff = 6.0,
                                                   recorder::Observer* also = nullptr);

/// Facts about a motion file that the file does not hold.
struct SamplesContext {
  recorder::Outcome outcome = recorder::Outcome::stopped;
  std::string handedness = "unknown";
  double cutoff = motionCutoff;  ///< Hz; values that are stored are of the default
};

/// The motion of one hand: every row is a sample.
Motion motionOf(const recorder::TrackedMotion& tracked, std::size_t hand, double cutoff = motionCutoff);

/// The figures that motion alone can give (those whose definition allows the origin `samples`), in the registry's
/// order. The attempt lasts from the first row to the last.
std::vector<CheckpointValue> valuesFromSamples(const recorder::TrackedMotion& tracked, const SamplesContext& context);

}  // namespace calot::analytics
