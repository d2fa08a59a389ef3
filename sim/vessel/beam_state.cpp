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

}  // namespace calot
