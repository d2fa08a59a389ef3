// SPDX-License-Identifier: GPL-3.0-or-later
// How the way is divided between the hands.
#include "analytics/checkpoints/checkpoint.h"

#include <fmt/format.h>

#include "analytics/checkpoints/movements.h"
#include "analytics/checkpoints/two_hands.h"

namespace calot::analytics {
namespace {

constexpr double minPath = 1e-3;  ///< m

const CheckpointDefinition& handRatioDefinition() {
  static const CheckpointDefinition d = [] {
    CheckpointDefinition ratio =
        motionDefinition("hand-ratio", "Right hand's share of both paths", "1", Direction::none,
                         "L_right / (L_left + L_right), L as in path-length; the value's note gives the handedness");
    ratio.displayUnit = std::string("%");
    ratio.displayFactor = 100.0;
    ratio.aggregation = Aggregation::attempt;
    ratio.instruments = "both hands together";
    return ratio;
  }();
  return d;
}

Measured handRatioOf(const Motion& left, const Motion& right, const AttemptContext& context) {
  const double l = pathLength(left), r = pathLength(right);
  if (!(l + r >= minPath)) return Measured::notApplicable("neither hand moved: both paths together are below 1 mm");
  return Measured::of(r / (l + r), fmt::format("handedness {}", context.handedness));
}

}  // namespace

std::vector<CheckpointEntry> handRatioEntries() {
  return {{{CheckpointFamily::motion, 150}, handRatioDefinition(), [](const AttemptContext& context) {
             return ofBothHands(handRatioDefinition(), handRatioOf, context);
           }}};
}

}  // namespace calot::analytics
