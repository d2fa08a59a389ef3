// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "recorder/compare.h"
#include "recorder/observer.h"
#include "recorder/recording/reader.h"
#include "recorder/replay.h"

namespace calot::recorder {

/// Compares every step of a session that re-simulates a recording: forces, digests, observables and events; where there
/// is a keyframe, State, haptic states and contact sets byte for byte.
class StepComparison final : public Observer {
 public:
  /// @param recording, model outlive it.
  StepComparison(Recording& recording, const Model& model);

  void onStep(const StepRecord& record) override;
  void onEnd(Outcome /*outcome*/) override {}

  [[nodiscard]] const std::optional<Divergence>& first() const { return first_; }
  /// Nothing more can be learned by going on.
  [[nodiscard]] bool done() const { return first_ && resolved_; }
  /// The recording itself cannot be followed any further.
  void fail(Divergence divergence);

 private:
  std::optional<std::size_t> keyframeAt(std::uint64_t step);
  std::optional<Divergence> compareDigests(const RecordedStep& recorded, const StepRecord& record);
  void resolveAtKeyframe(const StepRecord& record);

  Recording& recording_;
  const Model& model_;
  ResultComparison compareResult_;
  bool minimal_;      ///< no forces, no keyframes
  bool exactForces_;  ///< format version 1: forces as they were, digests of components
  BriefDigest brief_;
  std::optional<Divergence> first_;
  bool resolved_ = false;
};

}  // namespace calot::recorder
