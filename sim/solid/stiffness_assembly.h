// SPDX-License-Identifier: GPL-3.0-or-later
// The matrix of a step without what is attached to the solid: (1 + alpha h) M + (h^2 + beta h) K, of which a block is
// assembled anew only where an element at it has turned or has been carved.
//
// Forces take each element's rotation as it is, K takes it to a grain: rounded to multiples of it, then normalised. So
// most elements of most steps have the K of the step before, which need not be made again; and what K is depends on
// State alone, not on what was kept. Its error is that of a Jacobian: it changes how fast a motion that is under way
// goes on within a step by about the grain's angle, and no equilibrium.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/math/executor.h"
#include "sim/solid/hexahedral_elements.h"
#include "sim/solid/polar.h"
#include "sim/solid/solid_model.h"
#include "sim/solid/tetrahedral_elements.h"

namespace calot {

class StiffnessAssembly {
 public:
  struct Scale {
    double mass = 1.0;       ///< 1 + alpha h
    double stiffness = 0.0;  ///< h^2 + beta h (s^2)
    double grain = 0.0;      ///< of the quaternions' components; 0: rotations as they are

    bool operator==(const Scale&) const = default;
  };

  /// Values of the matrix (BlockMatrix), without attachments; stand until the next call.
  /// @param system of the model, or of the part of it that is there
  /// @param fill per cube, or empty  @param mass of the nodes (kg)
  /// @pre always called with the same model
  const std::vector<float>& update(const SolidModel& model, const SolidSystem& system,
                                   std::span<const RotationGroup> rotation, std::span<const double> fill,
                                   std::span<const double> mass, const Scale& scale, Executor& executor);
  /// The system is another one from the next update() on.
  void restructure() { values_.clear(); }

 private:
  /// What the blocks of a group of elements were made of.
  struct Made {
    RotationGroup rotation;
    std::array<double, laneCount> fill;
  };
  using Block = std::array<float, 9>;

  void makeElements(const SolidModel& model, std::span<const RotationGroup> rotation, std::span<const double> fill,
                    Executor& executor);
  void addTetrahedra(const SolidModel& model, const SolidSystem& system, const SolidSystem::Slot& slot,
                     Block& block) const;
  void addCubes(const SolidSystem& system, const SolidSystem::Slot& slot, Block& block) const;

  Scale scale_;
  std::vector<Made> made_;
  std::vector<std::uint8_t> changed_;       ///< per group of elements: a bit for each lane
  std::vector<RotatedGradients> gradient_;  ///< of tetrahedra
  std::vector<HexahedronBlocks> cube_;      ///< of cubes, unused lanes too
  std::vector<std::uint8_t> stale_;         ///< per block of the matrix
  std::vector<float> values_;
};

}  // namespace calot
