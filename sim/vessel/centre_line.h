// SPDX-License-Identifier: GPL-3.0-or-later
// The centre line of a vessel between its nodes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sim/math/linear.h"
#include "sim/vessel/beam_state.h"

namespace calot {

/// Side of the parting on which a point of a parted element lies.
enum class Stump : std::uint8_t { none, before, after };

/// Position and frame (z along the vessel towards its end, x and y across it) in W. In a whole element: a cubic
/// Hermite curve through the nodes, with their z axes times the chord's length as tangents, and blended frames; both
/// are free of kinks at nodes. In a parted element: the reference chord, fixed to the stump's node.
/// @pre where.element is of branch where.branch
Pose centreLine(const BeamModel& model, const BeamState& state, const BeamPoint& where, Stump stump = Stump::none);

/// Nodes that a point of the centre line depends on, with weights that sum to one.
struct BeamInfluence {
  std::array<int, 2> node{};
  std::array<double, 2> weight{};
  std::size_t count = 0;
};

/// A force on the wall acts on the centre line, distributed linearly over the element's nodes. Its moment about
/// the centre line (force times radius) is neglected: the surroundings constrain the vessel, and tools drag
/// rather than twist it.
BeamInfluence influenceOf(const BeamModel& model, const BeamPoint& where, Stump stump = Stump::none);

/// Side of the parting on which a point lies; none in a whole element.
Stump stumpAt(const BeamState& state, const BeamPoint& where);

// Frames along a centre line, in deterministic arithmetic.

/// q / |q|.
Quat normalised(const Quat& q);

/// (1 - t) a + t b, normalised, b with the sign nearer to a. For t = 1/2 this is the geodesic mean.
Quat blend(const Quat& a, const Quat& b, double t);

/// Rotation by the smallest angle from unit vector `from` to unit vector `to`; about some normal if they are opposite.
Quat minimalRotation(const Vec3& from, const Vec3& to);

/// A frame with this z axis (unit) whose x axis is as close as possible to the axis of W that is farthest from z.
Quat frameAlong(const Vec3& z);

/// Rotation of b relative to a about axis n by theta: tan(theta/4) n in W (modified Rodrigues parameters; at most 1).
Vec3 quarterTangent(const Quat& a, const Quat& b);

/// q rotated about the vector w in W by the angle whose tangent is |w|: one step of rotation. A rod d whose end
/// moves along a straight line by w x d rotates by exactly that angle, so that positions and orientations stay
/// consistent in large steps.
Quat rotated(const Quat& q, const Vec3& w);

}  // namespace calot
