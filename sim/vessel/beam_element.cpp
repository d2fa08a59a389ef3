// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/vessel/beam_element.h"

#include <algorithm>

#include "sim/math/linear.h"
#include "sim/vessel/centre_line.h"

namespace calot {

namespace {

/// D u for D = bending about all axes but this one, twisting about it.
Vec3 bent(const BeamElement& e, const Vec3& axis, const Vec3& u) {
  return e.bending * u + ((e.twisting - e.bending) * axis.dot(u)) * axis;
}

}  // namespace

BeamStrain strainOf(const BeamElement& e, const BeamState& state, std::size_t index) {
  const auto a = static_cast<std::size_t>(e.a);
  const auto b = static_cast<std::size_t>(e.b);
  BeamStrain out;
  out.chord = state.position[b] - state.position[a];
  const Mat3 middle = blend(state.orientation[a], state.orientation[b], 0.5).toRotationMatrix();
  out.axis = middle * e.axis;
  out.rotation = quarterTangent(state.orientation[a], state.orientation[b]);
  out.bendRate = 1.0 + out.rotation.squaredNorm();
  const double inverse = 1.0 / e.length;
  const Vec3 scaled = inverse * out.chord;
  out.stretch = scaled.norm() - 1.0;
  out.force = e.stretching * (scaled - middle * e.slack);
  Vec3 bend = bent(e, out.axis, out.rotation - middle * e.bend);
  const double sleeve = state.sleeve[index];
  if (sleeve > 0.0) {
    out.force += (sleeve * e.stretching) * (scaled - middle * state.sleeveStretch[index]);
    bend += sleeve * bent(e, out.axis, out.rotation - middle * state.sleeveBend[index]);
  }
  out.moment = (4.0 * inverse * out.bendRate) * bend;
  out.tension = out.force.dot(out.axis);
  return out;
}

BeamStiffness stiffnessOf(const BeamElement& e, const BeamStrain& s, double sleeve) {
  BeamStiffness out;
  const double inverse = 1.0 / e.length;
  // G_a = [d]x (1 + [p]x) / 2 with [d]x [p]x = p d^T - (d.p) 1; G_b likewise with -p.
  const Vec3& d = s.chord;
  const Vec3& p = s.rotation;
  Mat3 cross;
  cross << 0.0, -d[2], d[1], d[2], 0.0, -d[0], -d[1], d[0], 0.0;
  const double dot = d.dot(p);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double product = p[i] * d[j] - (i == j ? dot : 0.0);
      out.ga(i, j) = 0.5 * (cross(i, j) + product);
      out.gb(i, j) = 0.5 * (cross(i, j) - product);
      out.across(i, j) = (i == j ? 1.0 : 0.0) - s.axis[i] * s.axis[j];
    }
  }
  const double scale = inverse * s.bendRate * s.bendRate * (1.0 + sleeve);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      out.bend(i, j) = scale * ((i == j ? e.bending : 0.0) + (e.twisting - e.bending) * (s.axis[i] * s.axis[j]));
    }
  }
  out.stretch = inverse * (e.stretching * (1.0 + sleeve) + notNegative(-s.tension));
  out.string = inverse * notNegative(s.tension);
  return out;
}

}  // namespace calot
