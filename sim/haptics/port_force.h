// SPDX-License-Identifier: GPL-3.0-or-later
// What a real instrument's port does to the hand: friction of the trocar's seal along the shaft, resistance of the
// abdominal wall to tilting it. Shown to the hand; no part of contact, of forces on structures or of State.
#pragma once

#include "sim/math/linear.h"

namespace calot {

/// A port as the hand feels it. Zero: not at all.
struct PortModel {
  Vec3 port = Vec3::Zero();         ///< p_WP, pivot of the shaft (m)
  Vec3 neutralAxis = Vec3::Zero();  ///< unit, along which the wall holds the trocar by itself
  double trocarFriction = 0.0;      ///< largest friction along the shaft (N)
  double wallStiffness = 0.0;       ///< k, of the wall to tilting (N m/rad)
  /// Of a seal that sticks to the shaft (N/m): the hand's coupling stiffness, which the device renders stably. Assumed;
  /// more takes less of a stroke until it slips.
  double sealStiffness = 1000.0;

  [[nodiscard]] bool felt() const { return trocarFriction > 0.0 || wallStiffness > 0.0; }
};

/// Force on the hand at the tip (f_W, N).
/// Friction: Coulomb's, in Prandtl's form. The seal sticks to the shaft and is stretched by up to friction over
/// stiffness, then slips; so the force goes through zero continuously when the motion reverses, does not depend on the
/// noise of a speed, and never does work on the hand over a closed path.
/// Wall: torque k sin(tilt) about the port towards the neutral axis n, from the potential k (1 - n . a) with a the axis
/// of the shaft; as a force at the tip at distance L from the port, k (n - (n . a) a) / L. For small tilts k times
/// tilt.
/// @param seal distance of port and tip at which the seal is unstretched (m); moved where it slips; negative: here
/// @pre the tip is at least minInsertion from the port
Vec3 portForce(const PortModel& model, const Vec3& tip, double& seal);

}  // namespace calot
