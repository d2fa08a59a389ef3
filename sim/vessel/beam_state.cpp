// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/vessel/beam_state.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "sim/math/linear.h"

namespace calot {

namespace {

/// Smallest share of its element that a stump keeps.
constexpr double minStump = 0.1;

}  // namespace

BeamState restState(const BeamModel& model) {
  BeamState state;
  const std::size_t nodes = model.nodes();
  const std::size_t elements = model.elements().size();
  state.position = model.rest();
  state.orientation = model.restOrientation();
  state.velocity.assign(nodes, Vec3::Zero());
  state.angularVelocity.assign(nodes, Vec3::Zero());
  state.parting.assign(elements, Parting::none);
  state.partedAt.assign(elements, 0.0);
  state.peakStrain.assign(elements, 0.0);
  state.exposure.assign(model.stations(), 0.0);
  state.charring.assign(model.stations(), 0.0);
  state.sleeve.assign(elements, 0.0);
  state.sleeveStretch.assign(elements, Vec3::Zero());
  state.sleeveBend.assign(elements, Vec3::Zero());
  state.quietSteps = 1U << 20U;
  return state;
}

bool fits(const BeamModel& model, const BeamState& state) {
  const std::size_t nodes = model.nodes();
  const std::size_t elements = model.elements().size();
  const std::size_t clips = state.clips();
  if (state.position.size() != nodes || state.orientation.size() != nodes || state.velocity.size() != nodes ||
      state.angularVelocity.size() != nodes || state.parting.size() != elements || state.partedAt.size() != elements ||
      state.peakStrain.size() != elements || state.exposure.size() != model.stations() ||
      state.charring.size() != model.stations() || state.sleeve.size() != elements ||
      state.sleeveStretch.size() != elements || state.sleeveBend.size() != elements ||
      state.clipBranch.size() != clips || state.clipWidth.size() != clips || state.clipRoll.size() != clips ||
      state.clipClosure.size() != clips || state.clipEnclosed.size() != clips) {
    return false;
  }
  const auto within = [](double v, double lower, double upper) { return v >= lower && v <= upper; };
  for (std::size_t n = 0; n < nodes; ++n) {
    if (!state.position[n].allFinite() || !state.velocity[n].allFinite() || !state.angularVelocity[n].allFinite() ||
        !within(state.orientation[n].coeffs().squaredNorm(), 1.0 - 1e-9, 1.0 + 1e-9)) {
      return false;
    }
  }
  for (std::size_t e = 0; e < elements; ++e) {
    if (state.parting[e] > Parting::burned) return false;
    const bool parted = state.parting[e] != Parting::none;
    if (parted && !within(state.partedAt[e], minStump, 1.0 - minStump)) return false;
    if (!within(state.sleeve[e], 0.0, 1e6) || !state.sleeveStretch[e].allFinite() || !state.sleeveBend[e].allFinite()) {
      return false;
    }
  }
  for (std::size_t s = 0; s < model.stations(); ++s) {
    if (!within(state.exposure[s], 0.0, 1e9) || !within(state.charring[s], 0.0, 1e9)) return false;
  }
  for (std::size_t c = 0; c < clips; ++c) {
    if (state.clipBranch[c] >= model.branches().size() ||
        !within(state.clipPlace[c], 0.0, model.branches()[state.clipBranch[c]].length()) ||
        !within(state.clipWidth[c], 0.0, 1.0) || !within(state.clipRoll[c], -1e3, 1e3) ||
        !within(state.clipClosure[c], 0.0, 1.0) || !within(state.clipEnclosed[c], 0.0, 1.0)) {
      return false;
    }
  }
  return true;
}

BeamPoint pointAt(const BeamModel& model, std::size_t branch, double arcLength) {
  const BeamModel::Branch& b = model.branches()[branch];
  BeamPoint out;
  out.branch = branch;
  out.arcLength = std::min(notNegative(arcLength), b.length());
  std::size_t i = 0;
  while (i + 2 < b.arcLength.size() && b.arcLength[i + 1] <= out.arcLength) ++i;
  out.element = b.firstElement + i;
  out.share = std::min(notNegative((out.arcLength - b.arcLength[i]) / (b.arcLength[i + 1] - b.arcLength[i])), 1.0);
  return out;
}

bool part(BeamState& state, const BeamPoint& where, Parting how) {
  if (state.parting[where.element] != Parting::none || how == Parting::none) return false;
  state.parting[where.element] = how;
  state.partedAt[where.element] = std::clamp(where.share, minStump, 1.0 - minStump);
  // Wake the vessel.
  state.quietSteps = 0;
  return true;
}

BeamPoint closestPoint(const BeamModel& model, const BeamState& state, std::size_t branch, const Vec3& point,
                       double& distance) {
  const BeamModel::Branch& b = model.branches()[branch];
  BeamPoint out;
  out.branch = branch;
  double best = 1e300;
  const auto consider = [&](std::size_t i, const Vec3& from, const Vec3& to, double first, double last) {
    const Vec3 along = to - from;
    const double square = along.squaredNorm();
    const double t = square > 0.0 ? std::min(notNegative((point - from).dot(along) / square), 1.0) : 0.0;
    const double d = (point - (from + t * along)).squaredNorm();
    if (!(d < best)) return;
    best = d;
    out.element = b.firstElement + i;
    out.share = first + t * (last - first);
    out.arcLength = b.arcLength[i] + out.share * (b.arcLength[i + 1] - b.arcLength[i]);
  };
  for (std::size_t i = 0; i < b.elements(); ++i) {
    const std::size_t e = b.firstElement + i;
    const BeamElement& element = model.elements()[e];
    const auto na = static_cast<std::size_t>(element.a);
    const auto nb = static_cast<std::size_t>(element.b);
    const Vec3& pa = state.position[na];
    const Vec3& pb = state.position[nb];
    if (state.parting[e] == Parting::none) {
      consider(i, pa, pb, 0.0, 1.0);
      continue;
    }
    const double cut = state.partedAt[e];
    const Vec3 rest = model.rest()[nb] - model.rest()[na];
    const Vec3 fromA = state.orientation[na] * (model.restOrientation()[na].conjugate() * rest);
    const Vec3 fromB = state.orientation[nb] * (model.restOrientation()[nb].conjugate() * rest);
    consider(i, pa, pa + cut * fromA, 0.0, cut);
    consider(i, pb - (1.0 - cut) * fromB, pb, cut, 1.0);
  }
  distance = std::sqrt(best);
  return out;
}

namespace {

/// Frame of a branch at a node: the node's own, rotated where the branch grows out of another.
Quat branchFrame(const BeamModel::Branch& branch, const Quat& node, bool first) {
  return first && branch.join >= 0 ? normalised(node * branch.startFrame) : node;
}

}  // namespace

Stump stumpAt(const BeamState& state, const BeamPoint& where) {
  if (state.parting[where.element] == Parting::none) return Stump::none;
  return where.share <= state.partedAt[where.element] ? Stump::before : Stump::after;
}

Pose centreLine(const BeamModel& model, const BeamState& state, const BeamPoint& where, Stump stump) {
  const BeamModel::Branch& branch = model.branches()[where.branch];
  const BeamElement& e = model.elements()[where.element];
  const auto a = static_cast<std::size_t>(e.a);
  const auto b = static_cast<std::size_t>(e.b);
  const bool first = where.element == branch.firstElement;
  const double t = where.share;
  if (stump != Stump::none) {
    const std::size_t n = stump == Stump::before ? a : b;
    const double along = stump == Stump::before ? t : t - 1.0;
    const Vec3 chord = model.restOrientation()[n].conjugate() * (model.rest()[b] - model.rest()[a]);
    return {state.position[n] + along * (state.orientation[n] * chord),
            branchFrame(branch, state.orientation[n], first && n == a)};
  }
  const Quat qa = branchFrame(branch, state.orientation[a], first);
  const Quat& qb = state.orientation[b];
  const Vec3& xa = state.position[a];
  const Vec3& xb = state.position[b];
  const double length = (xb - xa).norm();
  const double s = 1.0 - t;
  const Vec3 ta = length * (qa * Vec3::UnitZ());
  const Vec3 tb = length * (qb * Vec3::UnitZ());
  const Vec3 line =
      (s * s * (1.0 + 2.0 * t)) * xa + (t * t * (1.0 + 2.0 * s)) * xb + (t * s * s) * ta - (t * t * s) * tb;
  return {line, blend(qa, qb, t)};
}

BeamInfluence influenceOf(const BeamModel& model, const BeamPoint& where, Stump stump) {
  const BeamElement& e = model.elements()[where.element];
  BeamInfluence out;
  if (stump != Stump::none || where.share == 0.0 || where.share == 1.0) {
    const bool start = stump == Stump::before || (stump == Stump::none && where.share == 0.0);
    out.node[0] = start ? e.a : e.b;
    out.weight[0] = 1.0;
    out.count = 1;
  } else {
    out.node = {e.a, e.b};
    out.weight = {1.0 - where.share, where.share};
    out.count = 2;
  }
  return out;
}

Quat normalised(const Quat& q) {
  const double w = q.w();
  const double x = q.x();
  const double y = q.y();
  const double z = q.z();
  const double inverse = 1.0 / std::sqrt((w * w + x * x) + (y * y + z * z));
  return {w * inverse, x * inverse, y * inverse, z * inverse};
}

Quat blend(const Quat& a, const Quat& b, double t) {
  const double dot = (a.w() * b.w() + a.x() * b.x()) + (a.y() * b.y() + a.z() * b.z());
  const double s = 1.0 - t;
  const double u = dot < 0.0 ? -t : t;
  return normalised({s * a.w() + u * b.w(), s * a.x() + u * b.x(), s * a.y() + u * b.y(), s * a.z() + u * b.z()});
}

Quat minimalRotation(const Vec3& from, const Vec3& to) {
  const double dot = from.dot(to);
  if (dot < -0.999999) {
    const Vec3 normal = frameAlong(from) * Vec3::UnitX();
    return {0.0, normal[0], normal[1], normal[2]};
  }
  const Vec3 cross = from.cross(to);
  return normalised({1.0 + dot, cross[0], cross[1], cross[2]});
}

Quat frameAlong(const Vec3& z) {
  const Vec3 size = z.cwiseAbs();
  const int k = size[0] <= size[1] && size[0] <= size[2] ? 0 : (size[1] <= size[2] ? 1 : 2);
  Vec3 x = Vec3::Unit(k) - z * z[k];
  x /= x.norm();
  Mat3 r;
  r.col(0) = x;
  r.col(1) = z.cross(x);
  r.col(2) = z;
  return normalised(Quat(r));
}

Vec3 quarterTangent(const Quat& a, const Quat& b) {
  Quat rotation = b * a.conjugate();
  if (rotation.w() < 0.0) rotation.coeffs() = -rotation.coeffs();
  return rotation.vec() / (1.0 + rotation.w());
}

Quat rotated(const Quat& q, const Vec3& w) {
  const Quat rotation(1.0 + std::sqrt(1.0 + w.squaredNorm()), w[0], w[1], w[2]);
  return normalised(rotation * q);
}

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
