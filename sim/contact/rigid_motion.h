// SPDX-License-Identifier: GPL-3.0-or-later
// The rigid motion that some places have in common. Internal to this folder.
#pragma once

#include <cstddef>
#include <span>

#include "sim/math/linear.h"

namespace calot {

/// x -> rotation x + shift, by which places come nearest to where they are now: two Gauss-Newton steps, enough for a
/// tenth of a revolution. It is rigid whatever the places are. @pre as many of both, and one at least
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
      if (!(half.squaredNorm() < 1.0)) break;  // all on one line, or more than it can tell: as it is
      rotation = Quat(1.0, half[0], half[1], half[2]).normalized().toRotationMatrix() * rotation;
    }
    shift = to - rotation * from;
  }
};

}  // namespace calot
