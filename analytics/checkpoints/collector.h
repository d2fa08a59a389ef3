// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"

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

}  // namespace calot::analytics
