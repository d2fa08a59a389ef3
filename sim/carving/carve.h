// SPDX-License-Identifier: GPL-3.0-or-later
// Carving: a tool removes the tissue that it sweeps over, in the reference configuration.
#pragma once

#include <cstddef>
#include <limits>
#include <span>

#include "sim/carving/carved_field.h"
#include "sim/math/linear.h"
#include "sim/math/vectors.h"

namespace calot {

// Distance of moving tissue to a moving capsule, eight nodes at a time.

/// A capsule that moved from segment p0-p1 to segment q0-q1 (m, W).
struct SweptCapsule {
  Vec3 p0 = Vec3::Zero();
  Vec3 p1 = Vec3::Zero();
  Vec3 q0 = Vec3::Zero();
  Vec3 q1 = Vec3::Zero();
  double radius = 0.0;  ///< m
};

/// Current and previous positions of eight nodes and the deformation gradients there, coordinate by coordinate.
struct NodeLanes {
  double now[3][laneCount];       ///< deformed positions (m, W)
  double before[3][laneCount];    ///< the same when the capsule was at p (m, W)
  double gradient[9][laneCount];  ///< F = dx/dX, row by row: element 3 r + c is dx_r / dX_c
};

/// Raises out[i] to the tool's potential at node i, where that is higher, for each capsule of the tool:
///
///   (radius - d) / |F^T n|
///
/// d is the distance of x = now[i] from the region that the segment swept *relative to the tissue*: from the previous
/// segment, translated by x - before[i], to the current one along straight lines, as the two triangles that the four
/// ends span. n is the unit vector from the nearest point to x. The divisor is the rate of change of the distance in
/// the reference configuration, so that the result is again a distance; it is omitted for d = 0. Exact for degenerate
/// sweeps: a capsule that does not move, a sphere, a stroke along the axis.
///
/// @param reach potentials below -reach may be omitted (m)
/// @return false: no node is near enough; `out` is unchanged
bool toolPotential(std::span<const SweptCapsule> tool, const NodeLanes& nodes, double reach, double (&out)[laneCount]);

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
