// SPDX-License-Identifier: GPL-3.0-or-later
// Movements of the tip: how many there were, and how straight.
#include "analytics/checkpoints/checkpoint.h"

#include <cmath>

#include "analytics/checkpoints/hand_motion.h"
#include "analytics/checkpoints/movements.h"

namespace calot::analytics {
namespace {

const CheckpointDefinition& countDefinition() {
  static const CheckpointDefinition d =
      motionDefinition("movements", "Number of movements", "1", Direction::lower,
                       "#{maximal stretches of points with v(k) >= max(v_95 / 2, 5 mm/s) that last 0.2 s or longer}, "
                       "v as in speed-mean, v_95 the hand's speed-p95 over the attempt, a point lasting 10 ms");
  return d;
}

const CheckpointDefinition& straightnessDefinition() {
  static const CheckpointDefinition d =
      motionDefinition("movement-straightness", "Straightness of the movements", "1", Direction::higher,
                       "sum over movements of |p(last) - p(first)| / sum over movements of their path length; "
                       "movements as in movements");
  return d;
}

Measured count(const Motion& motion) {
  std::size_t movements = 0;
  for (const MotionSegment& segment : motion.segments) movements += movementsOf(segment, motion.movementSpeed).size();
  return Measured::of(static_cast<double>(movements), thresholdNote(motion));
}

/// The chord as a share of the path, not the path over the chord: a movement that returns to its start has a chord of
/// 0.
Measured straightness(const Motion& motion) {
  double chord = 0.0, path = 0.0;
  for (const MotionSegment& segment : motion.segments) {
    for (const Stretch& movement : movementsOf(segment, motion.movementSpeed)) {
      const Vec3 d = segment.filtered[movement.end - 1] - segment.filtered[movement.begin];
      chord += std::sqrt(d.x() * d.x() + d.y() * d.y() + d.z() * d.z());
      path += pathLength(segment, movement.begin, movement.end);
    }
  }
  if (!(path > 0.0)) return Measured::notApplicable(noMovement(motion));
  return Measured::of(chord / path);
}

}  // namespace

std::vector<CheckpointEntry> movementsEntries() {
  return {{{CheckpointFamily::motion, 60},
           countDefinition(),
           [](const AttemptContext&) { return perHand(countDefinition(), count); }},
          phaseMotionEntry<countDefinition, count>(60),
          {{CheckpointFamily::motion, 70}, straightnessDefinition(), [](const AttemptContext&) {
             return perHand(straightnessDefinition(), straightness);
           }}};
}

}  // namespace calot::analytics
