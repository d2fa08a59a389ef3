// SPDX-License-Identifier: GPL-3.0-or-later
// How far the tip went in and out along its own shaft: what the picture, which is flat, shows worst.
#include "analytics/checkpoints/checkpoint.h"
#include "sim/math/no_fused_pairs.h"  // first

#include <cmath>

#include "analytics/checkpoints/hand_motion.h"

namespace calot::analytics {
namespace {

const CheckpointDefinition& depthPathDefinition() {
  static const CheckpointDefinition d = [] {
    CheckpointDefinition depth = motionDefinition(
        "depth-path", "Path along the instrument's axis", "m", Direction::lower,
        "sum |(p(k+1) - p(k)) . (z(k) + z(k+1)) / 2|, p the filtered tip, z the instrument's axis towards the tip "
        "(third column of the filtered orientation), within segments");
    depth.displayUnit = "mm";
    depth.displayFactor = 1000.0;
    return depth;
  }();
  return d;
}

/// Third column of the rotation matrix of a unit quaternion.
Vec3 axisOf(const Quat& q) {
  return {2.0 * (q.x() * q.z() + q.w() * q.y()), 2.0 * (q.y() * q.z() - q.w() * q.x()),
          1.0 - 2.0 * (q.x() * q.x() + q.y() * q.y())};
}

Measured depthPathOf(const Motion& motion) {
  double path = 0.0;
  for (const MotionSegment& segment : motion.segments) {
    if (segment.orientation.empty()) return Measured::notAvailable("the orientation was not recorded");
    Vec3 before = axisOf(segment.orientation.front());
    for (std::size_t i = 1; i < segment.filtered.size(); ++i) {
      const Vec3 axis = axisOf(segment.orientation[i]);
      const Vec3 step = segment.filtered[i] - segment.filtered[i - 1];
      const double along =
          step.x() * (before.x() + axis.x()) + step.y() * (before.y() + axis.y()) + step.z() * (before.z() + axis.z());
      path += std::abs(along) / 2.0;
      before = axis;
    }
  }
  return Measured::of(path);
}

}  // namespace

std::vector<CheckpointEntry> depthPathEntries() {
  return {{{CheckpointFamily::motion, 20},
           depthPathDefinition(),
           [](const AttemptContext&) { return perHand(depthPathDefinition(), depthPathOf); }},
          phaseMotionEntry<depthPathDefinition, depthPathOf>(30)};
}

}  // namespace calot::analytics
