// SPDX-License-Identifier: GPL-3.0-or-later
// Small fixed-size linear algebra: Eigen without its vectorisation (docs/explanation/determinism.md).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace calot {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;  ///< unit quaternion; stored and printed as w, x, y, z
using Index3 = Eigen::Matrix<int, 3, 1>;
using Index4 = Eigen::Matrix<int, 4, 1>;

/// Rigid pose of a frame B in W: p_W = position + orientation * p_B (m; unit quaternion).
struct Pose {
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();
};

/// Axis-aligned box (m). Empty while lower > upper.
struct Box {
  Vec3 lower = Vec3::Constant(1e300);
  Vec3 upper = Vec3::Constant(-1e300);

  void include(const Vec3& p) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  void grow(double margin) {
    lower.array() -= margin;
    upper.array() += margin;
  }
  [[nodiscard]] bool overlaps(const Box& o) const {
    return (lower.array() <= o.upper.array()).all() && (o.lower.array() <= upper.array()).all();
  }
};

// Numbers kept on one side of zero. std::max(x, 0.0), std::min(0.0, x) and std::clamp(x, 0.0, y) say the same, but
// which zero they give of -0 and 0 is lost where clang 14 makes one instruction of them that orders the two zeros: fmax
// and fminnm on aarch64, fmin on RISC-V, f64.max on WebAssembly. It leaves the comparisons here alone.

/// x, and 0 where it is negative or no number. -0 stays -0.
[[nodiscard]] constexpr double notNegative(double x) { return x >= 0.0 ? x : 0.0; }

/// x, and 0 where it is positive or no number. -0 becomes 0.
[[nodiscard]] constexpr double notPositive(double x) { return 0.0 - notNegative(-x); }

/// Component by component.
[[nodiscard]] inline Vec3 notNegative(const Vec3& v) {
  return {notNegative(v[0]), notNegative(v[1]), notNegative(v[2])};
}

}  // namespace calot
