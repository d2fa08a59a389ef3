// SPDX-License-Identifier: GPL-3.0-or-later
// The matrix of a step without what is attached to the solid: (1 + alpha h) M + (h^2 + beta h) K, K with the elements'
// rotations of this step. (Kept for some steps, or to a grain of rotation, it is cheaper; but where stiffness differs a
// thousandfold, as between a full cube and the next one that is nearly carved away, an error of 2 degrees in one is
// enough to make an implicit step unstable.)
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
  /// @param system of the model, or of the part of it that is there
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
