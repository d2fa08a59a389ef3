// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/vessel/centre_line.h"

#include <cmath>

namespace calot {

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

}  // namespace calot
