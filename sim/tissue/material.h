// SPDX-License-Identifier: GPL-3.0-or-later
// What descriptions of several kinds of tissue have in common.
#pragma once

#include <vector>

#include "sim/geometry/triangle_mesh.h"
#include "sim/math/fields.h"
#include "sim/math/linear.h"
#include "sim/solid/solid.h"

namespace calot {

/// Closed triangle surface of an organ in W, in the reference configuration (m).
struct SurfaceDescription {
  std::vector<Vec3> vertex;
  std::vector<Index3> triangle;  ///< outward

  [[nodiscard]] TriangleMesh mesh() const { return {vertex, triangle}; }

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("vertex", self.vertex);
    visit("triangle", self.triangle);
  }
};

/// Isotropic material of a co-rotational solid.
struct MaterialDescription {
  double youngModulus = 5000.0;    ///< Pa
  double poissonRatio = 0.45;      ///< in [0, 0.5)
  double density = 1060.0;         ///< kg/m^3
  double massDamping = 0.0;        ///< Rayleigh alpha (1/s)
  double stiffnessDamping = 0.01;  ///< Rayleigh beta (s)

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("youngModulus", self.youngModulus);
    visit("poissonRatio", self.poissonRatio);
    visit("density", self.density);
    visit("massDamping", self.massDamping);
    visit("stiffnessDamping", self.stiffnessDamping);
  }
};

inline SolidModel::Material solidMaterial(const MaterialDescription& m) {
  return {lameConstants(m.youngModulus, m.poissonRatio), m.density, m.massDamping, m.stiffnessDamping};
}

}  // namespace calot
