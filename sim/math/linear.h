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

}  // namespace calot
