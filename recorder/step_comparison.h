// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "recorder/compare.h"
#include "recorder/engine/engine.h"
#include "recorder/recording/reader.h"
#include "recorder/replay.h"

namespace calot::recorder {

/// Compares every step of an engine that re-simulates a recording: forces, digests, observables and events; where there
/// is a keyframe, State, haptic states and contact sets byte for byte.
class StepComparison {
 public:
  /// @param recording, engine outlive it.
  StepComparison(Recording& recording, Engine& engine);

  /// @pre it is the engine's newest
  void compare(const EngineStep& step);

  [[nodiscard]] const std::optional<Divergence>& first() const { return first_; }
  /// Nothing more can be learned by going on.
  [[nodiscard]] bool done() const { return first_ && resolved_; }
  /// The recording itself cannot be followed any further.
  void fail(Divergence divergence);

 private:
  std::optional<std::size_t> keyframeAt(std::uint64_t step);
  std::optional<Divergence> compareDigests(const RecordedStep& recorded, const EngineStep& step);
  std::optional<Divergence> compareKeyframe(std::size_t index);
  void resolveAtKeyframe(const EngineStep& step);

  Recording& recording_;
  Engine& engine_;
  ResultComparison compareResult_;
  bool minimal_;      ///< no forces, no keyframes
  bool exactForces_;  ///< format version 1: forces as they were, digests of components
  BriefDigest brief_;
  std::optional<Divergence> first_;
  bool resolved_ = false;
};

}  // namespace calot::recorder
