// SPDX-License-Identifier: GPL-3.0-or-later
// A lump of fat on a floor, and its steps.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sim/fat/fat_body.h"
#include "sim/math/executor.h"
#include "sim/math/random.h"

namespace calot::test {

/// An ellipsoid with waves, half axes in m; outward.
TriangleMesh lumpSurface(const Vec3& halfAxes, double wave = 0.06);
/// A box about the origin.
TriangleMesh boxSurface(const Vec3& half);

FatSettings fatSettings(double cell, int cellsPerCube = 3);

/// What lies below z = height.
FatPartner floorPartner(double height);

/// @pre there is such a fat
std::unique_ptr<const FatModel> fatOn(const TriangleMesh& surface, const FatSettings& settings,
                                      std::vector<FatPartner> partners, std::vector<FatRegion> regions = {});

/// Fat, its State and what a step needs.
struct FatRig {
  explicit FatRig(const FatModel& model);

  /// One step; ties pull towards their rest places, moved by `shift`.
  void move(const Vec3& gravity, std::span<const Vec3> force, const Vec3& shift = Vec3::Zero());
  /// Forces of the ties on the fat now, at rest (N), and about the origin (N m).
  void tieForces(Vec3& force, Vec3& moment) const;
  [[nodiscard]] double mass() const;

  const FatModel& model;
  FatBody body;
  FatState state;
  SolidSolver solver;
  SolidSolver::Settings settings;
  SerialExecutor executor;
};

/// The bytes of both parts of State.
std::vector<std::byte> bytesOfState(const FatState& state);

/// A capsule of radius r that sweeps by `length` anywhere in the box, turning as it goes.
SweptCapsule randomSweep(Random& random, const Box& box, double radius, double segment, double length);

/// Turns and shifts.
SweptCapsule placed(const SweptCapsule& capsule, const Pose& pose);

}  // namespace calot::test
