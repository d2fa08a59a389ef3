// SPDX-License-Identifier: GPL-3.0-or-later
// Rigid motion fitted to some points. Internal to this folder.
#pragma once

#include <cstddef>
#include <span>

#include "sim/math/linear.h"

namespace calot {

/// Least-squares rigid motion x -> rotation x + shift from `was` to `now`, by two Gauss-Newton steps: enough for a
/// tenth of a revolution. The result is rigid for any input. @pre was.size() == now.size() > 0
struct RigidMotion {
  Mat3 rotation = Mat3::Identity();
  Vec3 shift = Vec3::Zero();

  RigidMotion(std::span<const Vec3> was, std::span<const Vec3> now) {
    Vec3 from = Vec3::Zero();
    Vec3 to = Vec3::Zero();
    for (std::size_t i = 0; i < was.size(); ++i) {
      from += was[i] / static_cast<double>(was.size());
      to += now[i] / static_cast<double>(was.size());
    }
    for (int step = 0; step < 2; ++step) {
      Mat3 inertia = Mat3::Zero();
      Vec3 moment = Vec3::Zero();
      for (std::size_t i = 0; i < was.size(); ++i) {
        const Vec3 arm = rotation * (was[i] - from);
        inertia += arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose();
        moment += arm.cross(now[i] - to);
      }
      const Vec3 half = 0.5 * (inertia.inverse() * moment);
      if (!(half.squaredNorm() < 1.0)) break;  // collinear points or too large a rotation: stop here
      rotation = Quat(1.0, half[0], half[1], half[2]).normalized().toRotationMatrix() * rotation;
    }
    shift = to - rotation * from;
  }
};

}  // namespace calot
