// SPDX-License-Identifier: GPL-3.0-or-later
// Interpolation of a carved field.
#pragma once

#include "sim/carving/carved_field.h"

namespace calot {

/// Value (m) and gradient (m per cell) at a point given in cells from the lattice's origin.
struct FieldSample {
  double value = 0.0;
  Vec3 gradient = Vec3::Zero();
};

/// Trilinear within each cell: the value is continuous, the gradient is not. Points outside the lattice are
/// clamped to its border.
[[nodiscard]] FieldSample sampleField(const CarvedField& field, const Vec3& p);

/// The gradient where the surface cuts lattice edge `vertex` (surface_vertex): central differences at both ends,
/// interpolated. Continuous along the surface. (m per cell)
[[nodiscard]] Vec3 gradientAtVertex(const CarvedField& field, std::uint32_t vertex);

}  // namespace calot
