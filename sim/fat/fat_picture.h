// SPDX-License-Identifier: GPL-3.0-or-later
// The surface of carved fat for rendering.
#pragma once

#include <array>
#include <vector>

#include "sim/carving/adaptive_surface.h"
#include "sim/carving/carved_field.h"
#include "sim/fat/fat_model.h"

namespace calot {

/// The adaptive surface of a body of fat over successive States. If a State is more carved than the previous one, only
/// the affected parts are polygonized again, otherwise all. Vertices and triangles depend on the State alone.
class FatPicture {
 public:
  /// @param model outlives this. The uncarved body.
  explicit FatPicture(const FatModel& model);

  /// Updates to a State's carving; an invalid State counts as uncarved.
  /// @return true if vertices or triangles changed
  bool update(const CarvedBricks& carved);

  [[nodiscard]] const std::vector<Vec3>& rest() const { return mesh_.vertex; }  ///< m
  [[nodiscard]] const std::vector<Index3>& triangles() const { return mesh_.triangle; }
  /// Positions of the vertices (m, W). @param solid positions of the solid's nodes
  void positions(const std::vector<Vec3>& solid, std::vector<Vec3>& out) const;

 private:
  /// The cube that a vertex moves with: the one that contains it, or the nearest remaining one.
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
