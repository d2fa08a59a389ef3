// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/vessel_capsules.h"

#include "sim/step/body.h"
#include "sim/vessel/centre_line.h"

namespace calot {

SolidSolver::Impulse VesselCapsule::place(double s) const {
  SolidSolver::Impulse out;
  addShare(out, node0, 1.0 - s);
  addShare(out, node1, s);
  return out;
}

void vesselCapsules(const BeamModel& beams, const BeamState& state, std::size_t branch,
                    std::vector<VesselCapsule>& out) {
  out.clear();
  const BeamModel::Branch& fixed = beams.branches()[branch];
  for (std::size_t i = 0; i < fixed.elements(); ++i) {
    const std::size_t e = fixed.firstElement + i;
    const BeamElement& element = beams.elements()[e];
    const Vec3& a = state.position[static_cast<std::size_t>(element.a)];
    const Vec3& b = state.position[static_cast<std::size_t>(element.b)];
    if (state.parting[e] == Parting::none) {
      out.push_back({a, b, element.a, element.b, i, false});
      continue;
    }
    const BeamPoint cut{branch, e, state.partedAt[e], 0.0};
    out.push_back({a, centreLine(beams, state, cut, Stump::before).position, element.a, element.a, i, false});
    out.push_back({centreLine(beams, state, cut, Stump::after).position, b, element.b, element.b, i, true});
  }
}

TreeDistances::TreeDistances(const BeamModel& beams) : nodes_(beams.nodes()), distance_(nodes_ * nodes_, 1e300) {
  // Nodes stand behind their parents, so each row takes what the rows before it have.
  for (std::size_t n = 0; n < nodes_; ++n) {
    distance_[n * nodes_ + n] = 0.0;
    if (beams.parents()[n] < 0) continue;
    const auto parent = static_cast<std::size_t>(beams.parents()[n]);
    const double length = beams.elements()[static_cast<std::size_t>(beams.elementBefore(n))].length;
    for (std::size_t m = 0; m < n; ++m) {
      distance_[n * nodes_ + m] = distance_[m * nodes_ + n] = distance_[parent * nodes_ + m] + length;
    }
  }
}

}  // namespace calot
