// SPDX-License-Identifier: GPL-3.0-or-later
// How far the instrument turned, about whatever axis.
#include "analytics/checkpoints/checkpoint.h"
#include "sim/math/no_fused_pairs.h"  // first

#include <cmath>
#include <numbers>

#include "analytics/checkpoints/hand_motion.h"
#include "sim/math/elementary.h"

namespace calot::analytics {
namespace {

const CheckpointDefinition& angularPathDefinition() {
  static const CheckpointDefinition d = [] {
    CheckpointDefinition angle =
        motionDefinition("angular-path", "Angular path of the instrument", "rad", Direction::lower,
                         "sum angle(R(k)^T R(k+1)) over the filtered orientations (quaternion components filtered like "
                         "coordinates, then normalised), within segments");
    angle.displayUnit = "deg";
    angle.displayFactor = 180.0 / std::numbers::pi;
    return angle;
  }();
  return d;
}

/// Angle of the turn from a to b, in [0, pi]: 2 atan2(|v|, |w|) of a* b = (w, v), exact for small turns too.
double angleBetween(const Quat& a, const Quat& b) {
  const double w = a.w() * b.w() + a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
  const double x = a.w() * b.x() - a.x() * b.w() - a.y() * b.z() + a.z() * b.y();
  const double y = a.w() * b.y() + a.x() * b.z() - a.y() * b.w() - a.z() * b.x();
  const double z = a.w() * b.z() - a.x() * b.y() + a.y() * b.x() - a.z() * b.w();
  return 2.0 * arctangent2(std::sqrt(x * x + y * y + z * z), std::abs(w));
}

Measured angularPathOf(const Motion& motion) {
  double path = 0.0;
  for (const MotionSegment& segment : motion.segments) {
    if (segment.orientation.empty()) return Measured::notAvailable("the orientation was not recorded");
    for (std::size_t i = 1; i < segment.orientation.size(); ++i)
      path += angleBetween(segment.orientation[i - 1], segment.orientation[i]);
  }
  return Measured::of(path);
}

}  // namespace

std::vector<CheckpointEntry> angularPathEntries() {
  return {{{CheckpointFamily::motion, 30},
           angularPathDefinition(),
           [](const AttemptContext&) { return perHand(angularPathDefinition(), angularPathOf); }},
          phaseMotionEntry<angularPathDefinition, angularPathOf>(40)};
}

}  // namespace calot::analytics
