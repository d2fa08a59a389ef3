// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/vessel/centre_line.h"

#include "sim/vessel/frames.h"

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

}  // namespace calot
