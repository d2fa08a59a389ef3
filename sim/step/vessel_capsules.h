// SPDX-License-Identifier: GPL-3.0-or-later
// Vessels as capsules, for their contact with other tissue: one along each element; two where it is parted, one a
// stump. Internal to this folder.
#pragma once

#include <cstddef>
#include <vector>

#include "sim/scene/model.h"
#include "sim/scene/state.h"
#include "sim/solid/solid.h"

namespace calot {

/// A straight piece of a vessel.
struct VesselCapsule {
  Vec3 p0 = Vec3::Zero();  ///< ends of its axis, towards the vessel's start and end (m, W)
  Vec3 p1 = Vec3::Zero();
  int node0 = 0;  ///< nodes that the ends follow; of a stump, both are the node that it hangs on
  int node1 = 0;
  std::size_t element = 0;  ///< of the branch, from 0
  bool after = false;       ///< the stump beyond a parting

  /// A place on its axis in terms of the vessel's nodes. @param s share of the way from p0 to p1
  [[nodiscard]] SolidSolver::Impulse place(double s) const;
};

/// Capsules of a branch in the order of its elements.
void vesselCapsules(const BeamModel& beams, const BeamState& state, std::size_t branch,
                    std::vector<VesselCapsule>& out);

/// Distances along a tree of vessels between its nodes at rest (m).
class TreeDistances {
 public:
  explicit TreeDistances(const BeamModel& beams);
  [[nodiscard]] double between(int a, int b) const {
    return distance_[static_cast<std::size_t>(a) * nodes_ + static_cast<std::size_t>(b)];
  }

 private:
  std::size_t nodes_;
  std::vector<double> distance_;
};

}  // namespace calot
