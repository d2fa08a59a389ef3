// SPDX-License-Identifier: GPL-3.0-or-later
// How far organs and vessels have moved since the last step, and where vessels are: what is far apart is not searched
// for contact until it may have come near. Internal to this folder.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sim/math/bounds.h"
#include "sim/step/bodies.h"
#include "sim/step/surfaces.h"
#include "sim/step/vessel_capsules.h"

namespace calot {

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
