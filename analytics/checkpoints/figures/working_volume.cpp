// SPDX-License-Identifier: GPL-3.0-or-later
// The room that the tip worked in. A box would be the size of its two farthest excursions.
#include "analytics/checkpoints/checkpoint.h"
#include "sim/math/no_fused_pairs.h"  // first

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "analytics/checkpoints/hand_motion.h"
#include "sim/math/linear.h"

namespace calot::analytics {
namespace {

/// 95 % quantile of the chi-squared distribution with 3 degrees of freedom.
constexpr double chiSquared = 7.814727903251179;

const CheckpointDefinition& workingVolumeDefinition() {
  static const CheckpointDefinition d = [] {
    CheckpointDefinition volume = motionDefinition(
        "working-volume", "Working volume of the instrument's tip", "m^3", Direction::lower,
        "4/3 pi (7.814727903)^(3/2) sqrt(det S): the ellipsoid of normally distributed points that holds 95 % of them; "
        "S the covariance (divisor n - 1) of all filtered points");
    volume.displayUnit = "ml";
    volume.displayFactor = 1e6;
    return volume;
  }();
  return d;
}

Measured workingVolumeOf(const Motion& motion) {
  // A piece of a phase may be a single point, which has no covariance.
  if (motion.points() < 2) return Measured::notAvailable("fewer than two points of motion");
  const auto n = static_cast<double>(motion.points());
  Vec3 mean = Vec3::Zero();
  for (const MotionSegment& segment : motion.segments) {
    for (const Vec3& p : segment.filtered) mean += p;
  }
  mean /= n;
  std::array<double, 6> s{};  // xx yy zz xy xz yz
  for (const MotionSegment& segment : motion.segments) {
    for (const Vec3& p : segment.filtered) {
      const double x = p.x() - mean.x(), y = p.y() - mean.y(), z = p.z() - mean.z();
      s[0] += x * x;
      s[1] += y * y;
      s[2] += z * z;
      s[3] += x * y;
      s[4] += x * z;
      s[5] += y * z;
    }
  }
  for (double& value : s) value /= n - 1.0;
  const double determinant =
      s[0] * (s[1] * s[2] - s[5] * s[5]) - s[3] * (s[3] * s[2] - s[5] * s[4]) + s[4] * (s[3] * s[5] - s[1] * s[4]);
  // Motion in a plane or on a line fills none; rounding may make its determinant negative.
  return Measured::of(4.0 / 3.0 * std::numbers::pi * chiSquared * std::sqrt(chiSquared) *
                      std::sqrt(notNegative(determinant)));
}

}  // namespace

std::vector<CheckpointEntry> workingVolumeEntries() {
  return {{{CheckpointFamily::motion, 160},
           workingVolumeDefinition(),
           [](const AttemptContext&) { return perHand(workingVolumeDefinition(), workingVolumeOf); }},
          phaseMotionEntry<workingVolumeDefinition, workingVolumeOf>(100)};
}

}  // namespace calot::analytics
