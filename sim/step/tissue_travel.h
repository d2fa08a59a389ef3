// SPDX-License-Identifier: GPL-3.0-or-later
// Travel of organs and vessels since the last step, and bounds of vessels: bodies that are far apart are not searched
// for contact until it may have come near. Internal to this folder.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sim/math/linear.h"
#include "sim/scene/model.h"
#include "sim/scene/state.h"
#include "sim/solid/solid.h"
#include "sim/step/bodies.h"
#include "sim/step/surfaces.h"

namespace calot {

// Vessels as capsules, for their contact with other tissue: one along each element; two where it is parted, one a
// stump. Internal to this folder.

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

/// As far ahead as contact is sought for what comes fast (m). Larger: rows that stay open; smaller: passes through.
/// Assumed: what the fastest vessel goes in half a step.
inline constexpr double maxApproach = 0.05;

/// Derived from State alone, but from two of them: after a jump everything counts as moved.
class TissueTravel {
 public:
  struct Vessel {
    std::size_t tree = 0, branch = 0, structure = 0, body = 0;
    double radius = 0.0;  ///< m
    std::vector<VesselCapsule> rest;
    std::vector<VesselCapsule> now;
    std::vector<VesselCapsule> before;  ///< as `now` in the last follow()
    double motion = 0.0;                ///< largest of any end since the last follow() (m)
    double speed = 0.0;                 ///< largest of its tree's nodes (m/s)
  };

  explicit TissueTravel(const Model& model);

  /// To be called when the State was replaced.
  void invalidate();
  /// @pre surfaces are current
  void follow(const Surfaces& surfaces, const Bodies& bodies, const State& state, const std::vector<bool>& awake);

  /// In the order of structures.
  [[nodiscard]] std::span<const Vessel> vessels() const { return vessel_; }
  /// Largest motion of an organ's skin since the last follow() (m).
  [[nodiscard]] double organMotion(std::size_t organ) const { return organMotion_[organ]; }
  /// Largest speed of its nodes; 0 asleep (m/s).
  [[nodiscard]] double organSpeed(std::size_t organ) const { return organSpeed_[organ]; }

 private:
  const Model& model_;
  std::vector<Vessel> vessel_;
  std::vector<std::vector<Vec3>> organBefore_;
  std::vector<double> organMotion_, organSpeed_;
  std::vector<bool> wasAwake_;
};

/// Between the nearest points of two boxes (m).
inline double distanceOf(const Box& a, const Box& b) {
  return notNegative(Vec3((a.lower - b.upper).cwiseMax(b.lower - a.upper))).norm();
}

}  // namespace calot
