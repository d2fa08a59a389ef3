// SPDX-License-Identifier: GPL-3.0-or-later
// Time in which a hand, or both at once, stood still.
#include "analytics/checkpoints/checkpoint.h"

#include "analytics/checkpoints/hand_motion.h"
#include "analytics/checkpoints/movements.h"
#include "analytics/checkpoints/two_hands.h"

namespace calot::analytics {
namespace {

const CheckpointDefinition& idleTimeDefinition() {
  static const CheckpointDefinition d =
      motionDefinition("idle-time", "Time at rest", "s", Direction::lower,
                       "sum of the lengths of the maximal stretches of points with v(k) < 5 mm/s that last 0.5 s or "
                       "longer, v as in speed-mean, a point lasting 10 ms");
  return d;
}

const CheckpointDefinition& bothDefinition() {
  static const CheckpointDefinition d = [] {
    CheckpointDefinition both =
        motionDefinition("idle-time-both", "Time at rest of both hands at once", "s", Direction::lower,
                         "as idle-time, of the points at which both hands are measured and v(k) < 5 mm/s for both");
    both.window = "whole attempt, while both hands are mounted and measured";
    both.aggregation = Aggregation::attempt;
    both.instruments = "both hands at the same time";
    return both;
  }();
  return d;
}

double secondsOf(const std::vector<bool>& idle) {
  std::size_t points = 0;
  for (const Stretch& stretch : stretchesOf(idle, pointsOf(idleTime))) points += stretch.points();
  return static_cast<double>(points) / motionRate;
}

Measured idle(const Motion& motion) {
  double seconds = 0.0;
  for (const MotionSegment& segment : motion.segments) {
    std::vector<bool> slow(segment.speed.size());
    for (std::size_t i = 0; i < slow.size(); ++i) slow[i] = segment.speed[i] < idleSpeed;
    seconds += secondsOf(slow);
  }
  return Measured::of(seconds);
}

Measured idleOfBoth(const Motion& left, const Motion& right, const AttemptContext& /*context*/) {
  double seconds = 0.0;
  for (const CommonPart& part : commonParts(left, right, 0)) {
    std::vector<bool> slow(part.points);
    for (std::size_t i = 0; i < slow.size(); ++i) slow[i] = part.left[i] < idleSpeed && part.right[i] < idleSpeed;
    seconds += secondsOf(slow);
  }
  return Measured::of(seconds);
}

}  // namespace

std::vector<CheckpointEntry> idleTimeEntries() {
  return {{{CheckpointFamily::motion, 80},
           idleTimeDefinition(),
           [](const AttemptContext&) { return perHand(idleTimeDefinition(), idle); }},
          phaseMotionEntry<idleTimeDefinition, idle>(70),
          {{CheckpointFamily::motion, 90}, bothDefinition(), [](const AttemptContext& context) {
             return ofBothHands(bothDefinition(), idleOfBoth, context);
           }}};
}

}  // namespace calot::analytics
