// SPDX-License-Identifier: GPL-3.0-or-later
// Carving: a tool takes off what it sweeps over, in the rest space of the tissue.
#pragma once

#include <cstddef>
#include <span>

#include "sim/carving/carved_field.h"
#include "sim/carving/swept_capsule.h"

namespace calot {

/// Rest nodes lower <= n < upper.
struct NodeBox {
  Index3 lower = Index3::Zero();
  Index3 upper = Index3::Zero();
};

/// How the tissue moved, asked row by row.
class TissueMotion {
 public:
  virtual ~TissueMotion() = default;
  /// Fills lanes [0, count) for the nodes first, first + (1, 0, 0) and so on.
  /// @param box which of the boxes given to carve() they are of (a deformed cell knows its own nodes)
  virtual void place(std::size_t box, const Index3& first, int count, NodeLanes& out) const = 0;
};

/// Tissue that neither moves nor is strained.
class RestingTissue final : public TissueMotion {
 public:
  explicit RestingTissue(const BrickLattice& lattice) : lattice_(lattice) {}
  void place(std::size_t box, const Index3& first, int count, NodeLanes& out) const override;

 private:
  const BrickLattice& lattice_;
};

/// How deep below a carved surface the field is made a distance anew, in cells: what polygons and gradients read.
inline constexpr double carveDepth = 2.0;

/// Bounds (m, W) of all that a stroke can change, for choosing boxes: the sweep with its radius and, around it, the
/// depth (m) times `stretch`, the largest factor by which tissue is lengthened anywhere. Its motion since the previous
/// pose counts: hold the union of a cell's bounds now and before against this.
[[nodiscard]] Box sweptBounds(std::span<const SweptCapsule> tool, double depth, double stretch);

/// The box of nodes within bounds given in rest space (m), for tissue at rest.
[[nodiscard]] NodeBox nodesWithin(const BrickLattice& lattice, const Box& bounds);

/// phi = max(phi, the potential of the tool's swept capsules) at all nodes of the boxes where that potential is at
/// least -depth (toolPotential()). Every node is on its own: neither the order of boxes nor how nodes are dealt into
/// them matters. Between CarvedField::begin() and commit(). Allocates nothing.
/// @param tool capsules in W
/// @param boxes within the lattice; a node in two of them is carved by both
/// @param depth m; more than a cell, at most the field's band; carveDepth cells are enough for all that is made of it
void carve(CarvedField& field, std::span<const SweptCapsule> tool, std::span<const NodeBox> boxes,
           const TissueMotion& motion, double depth);

}  // namespace calot
