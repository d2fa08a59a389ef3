// SPDX-License-Identifier: GPL-3.0-or-later
// Carving: a tool removes the tissue that it sweeps over, in the reference configuration.
#pragma once

#include <cstddef>
#include <limits>
#include <span>

#include "sim/carving/carved_field.h"
#include "sim/carving/swept_capsule.h"

namespace calot {

/// Rest nodes lower <= n < upper.
struct NodeBox {
  Index3 lower = Index3::Zero();
  Index3 upper = Index3::Zero();
};

/// Motion of the tissue, evaluated row by row.
class TissueMotion {
 public:
  virtual ~TissueMotion() = default;
  /// Fills lanes [0, count) for the nodes first, first + (1, 0, 0) and so on.
  /// @param box index of the box given to carve() that contains them
  virtual void fillLanes(std::size_t box, const Index3& first, int count, NodeLanes& out) const = 0;
};

/// Tissue that neither moves nor deforms.
class UndeformedTissue final : public TissueMotion {
 public:
  explicit UndeformedTissue(const BrickLattice& lattice) : lattice_(lattice) {}
  void fillLanes(std::size_t box, const Index3& first, int count, NodeLanes& out) const override;

 private:
  const BrickLattice& lattice_;
};

/// Depth below a carved surface to which the field is recomputed as a distance, in cells: what
/// polygons and gradients need.
inline constexpr double carveDepth = 2.0;

/// Bounds (m, W) of all that a stroke can change, for choosing boxes: the sweep grown by its radius and by depth
/// (m) times `stretch`, the greatest stretch of the tissue. Test the union of a cell's bounds before and after
/// the stroke against these.
[[nodiscard]] Box sweptBounds(std::span<const SweptCapsule> tool, double depth, double stretch);

/// The box of nodes within bounds given in the reference configuration (m), for undeformed tissue.
[[nodiscard]] NodeBox nodesWithin(const BrickLattice& lattice, const Box& bounds);

/// phi = max(phi, the potential of the tool's swept capsules) at all nodes of the boxes where that potential is at
/// least -depth (toolPotential()); by no more than `rise` times the share of the step during which that potential, of
/// the tool as it moves, is above phi (sim/geometry/dwell.h): the surface recedes at rise / step at most, however the
/// time is divided into steps. Nodes are independent: neither the order of boxes nor the distribution of nodes
/// among them matters. Call between CarvedField::begin() and commit(). Allocates nothing.
/// @param tool capsules in W
/// @param boxes within the lattice; a node in two of them is carved by both
/// @param depth m; more than a cell, at most the field's band; carveDepth cells are sufficient
/// @param rise m; infinite: at once
void carve(CarvedField& field, std::span<const SweptCapsule> tool, std::span<const NodeBox> boxes,
           const TissueMotion& motion, double depth, double rise = std::numeric_limits<double>::infinity());

}  // namespace calot
