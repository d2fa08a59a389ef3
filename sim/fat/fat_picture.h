// SPDX-License-Identifier: GPL-3.0-or-later
// The surface of carved fat for those who draw it.
#pragma once

#include <array>
#include <vector>

#include "sim/carving/adaptive_surface.h"
#include "sim/carving/carved_field.h"
#include "sim/carving/fill.h"
#include "sim/fat/fat_model.h"

namespace calot {

/// The adaptive surface of a body of fat from State to State. Where more is carved in a State than in the one before,
/// only what that reaches is polygonized anew; else all of it is. Vertices and triangles depend on the State alone.
class FatPicture {
 public:
  /// @param model outlives this. The uncarved body.
  explicit FatPicture(const FatModel& model);

  /// Follows what a State has carved; a State that is not the model's counts as uncarved.
  /// @return are vertices and triangles others than before?
  bool update(const CarvedBricks& carved);

  [[nodiscard]] const std::vector<Vec3>& rest() const { return mesh_.vertex; }  ///< m
  [[nodiscard]] const std::vector<Index3>& triangles() const { return mesh_.triangle; }
  /// Where the vertices are (m, W). @param solid positions of the solid's nodes
  void place(const std::vector<Vec3>& solid, std::vector<Vec3>& out) const;

 private:
  /// A vertex goes with a cube: the one it lies in, or the nearest that is there.
  struct Carrier {
    std::array<int, 8> node{};
    std::array<double, 8> share{};
  };

  [[nodiscard]] bool there(int cube) const;
  [[nodiscard]] int cubeNear(const Vec3& rest) const;
  void weld();

  const FatModel& model_;
  CarvedField field_;
  Fill fill_;
  AdaptiveSurface surface_;
  TriangleMesh mesh_;
  std::vector<Carrier> carrier_;  ///< per vertex
};

}  // namespace calot
