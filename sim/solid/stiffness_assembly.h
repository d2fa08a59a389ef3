// SPDX-License-Identifier: GPL-3.0-or-later
// The matrix of a step without attachments: (1 + alpha h) M + (h^2 + beta h) K, with the elements' rotations of this
// step in K. Reusing K for several steps or small rotations would be cheaper. But where stiffness differs a
// thousandfold, as between a full cube and a nearly empty neighbour, a rotation error of 2 degrees is enough to make
// an implicit step unstable.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/math/executor.h"
#include "sim/solid/solid_model.h"

namespace calot {

class StiffnessAssembly {
 public:
  struct Scale {
    double mass = 1.0;       ///< 1 + alpha h
    double stiffness = 0.0;  ///< h^2 + beta h (s^2)
  };

  /// Writes the values of the matrix (BlockMatrix).
  /// @param system of the model, or of its remaining part
  /// @param fill per cube, or empty  @param mass of the nodes (kg)
  void assemble(const SolidModel& model, const SolidSystem& system, std::span<const RotationGroup> rotation,
                std::span<const double> fill, std::span<const double> mass, const Scale& scale, Executor& executor,
                std::vector<float>& values);

 private:
  void assembleTetrahedra(const SolidModel& model, const SolidSystem& system, std::span<const RotationGroup> rotation,
                          float scale, Executor& executor, std::vector<float>& values);
  void assembleCubes(const SolidModel& model, const SolidSystem& system, std::span<const RotationGroup> rotation,
                     std::span<const double> fill, float scale, Executor& executor, std::vector<float>& values);

  std::vector<float> tetrahedron_;      ///< rotated gradients and volume of each
  std::vector<HexahedronBlocks> cube_;  ///< of cubes, unused lanes too
};

}  // namespace calot
