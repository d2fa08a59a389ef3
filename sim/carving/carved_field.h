// SPDX-License-Identifier: GPL-3.0-or-later
// A body as the inside (value < 0) of a potential field on a lattice: the original, the changes and a working copy.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/geometry/brick_lattice.h"
#include "sim/math/linear.h"
#include "sim/math/vectors.h"

namespace calot {

// The nodes of one brick as bits: bit x + 8 y of word z. One word is a layer.

using BrickBits = std::array<std::uint64_t, 8>;

inline constexpr std::uint64_t columnFirst = 0x0101010101010101ULL;  ///< x = 0 in a layer
inline constexpr std::uint64_t columnLast = columnFirst << 7U;       ///< x = 7

[[nodiscard]] inline bool testBit(const BrickBits& bits, std::uint32_t local) {
  return (bits[local >> 6U] >> (local & 63U) & 1U) != 0;
}
[[nodiscard]] inline int countBits(const BrickBits& bits) {
  int n = 0;
  for (const std::uint64_t layer : bits) n += std::popcount(layer);
  return n;
}
[[nodiscard]] inline bool anyBit(const BrickBits& bits) {
  std::uint64_t all = 0;
  for (const std::uint64_t layer : bits) all |= layer;
  return all != 0;
}

/// Calls visit(local) for each set bit, ascending; local is the node's index in its brick, x + 8 (y + 8 z).
template <class Visit>
void forEachBit(const BrickBits& bits, Visit&& visit) {
  for (std::uint32_t z = 0; z < 8; ++z) {
    for (std::uint64_t layer = bits[z]; layer != 0; layer &= layer - 1) {
      visit(64 * z + static_cast<std::uint32_t>(std::countr_zero(layer)));
    }
  }
}

/// The set and its neighbours along the axes, within the brick.
[[nodiscard]] inline BrickBits dilated(const BrickBits& b) {
  BrickBits out;
  for (std::size_t z = 0; z < 8; ++z) {
    const std::uint64_t m = b[z];
    out[z] = m | ((m & ~columnLast) << 1U) | ((m & ~columnFirst) >> 1U) | (m << 8U) | (m >> 8U);
    if (z > 0) out[z] |= b[z - 1];
    if (z < 7) out[z] |= b[z + 1];
  }
  return out;
}

/// Nodes of brick `a` whose neighbour in brick `b`, next to it along +axis, is set too, as bits of one face: for x bit
/// 8 y + z, for y bit 8 z + x, for z bit 8 y + x.
[[nodiscard]] inline std::uint64_t sharedFace(const BrickBits& a, const BrickBits& b, int axis) {
  std::uint64_t face = 0;
  if (axis == 2) return a[7] & b[0];
  for (unsigned z = 0; z < 8; ++z) {
    if (axis == 0) {
      face |= ((a[z] >> 7U) & b[z] & columnFirst) << z;
    } else {
      face |= ((a[z] >> 56U) & b[z] & 0xFFU) << (8U * z);
    }
  }
  return face;
}

/// Index in brick `a` and in brick `b` of bit k of their sharedFace.
struct FacePair {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
};
[[nodiscard]] inline FacePair facePair(unsigned k, int axis) {
  const unsigned low = k & 7U;
  const unsigned high = k >> 3U;
  if (axis == 0) return {7 + 8 * (high + 8 * low), 8 * (high + 8 * low)};
  if (axis == 1) return {low + 8 * (7 + 8 * high), low + 64 * high};
  return {k + 64 * 7, k};
}

/// The uncarved field: signed distance in the reference configuration (m), clamped to +-band, outside on the lattice's
/// border. Part of Model.
struct FieldModel {
  BrickLattice lattice;
  double band = 0.0;          ///< m
  std::vector<double> value;  ///< m, by BrickLattice::node()

  /// Error that makes it unusable: wrong sizes, values that are not finite or beyond the band, inside on
  /// the border. Empty: none.
  [[nodiscard]] std::string fault() const;
};

/// Changes by carving, which are part of State: whole bricks in the order of their first change (ascending within one
/// stroke), so that a stroke moves no memory.
struct CarvedBricks {
  using Values = std::array<double, BrickLattice::brickNodes>;

  std::vector<std::uint32_t> brick;
  std::vector<Values> value;  ///< m

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("brick", self.brick);
    visit("value", self.value);
  }
};

/// The dense field with the inside as bits. Derived from FieldModel and CarvedBricks; never saved. All changes are made
/// in a stroke: begin(), writes, commit(). Allocates only in its constructor; commit() may grow CarvedBricks unless
/// reserve() reserved its capacity.
class CarvedField {
 public:
  /// @pre model.fault() is empty; the model outlives the field
  explicit CarvedField(const FieldModel& model);

  /// The field after a restore. @return false (and the uncarved field) if the bricks are invalid: out of range,
  /// repeated, sizes that differ, values not finite or beyond the band, inside on the border or in the padding.
  [[nodiscard]] bool restore(const CarvedBricks& bricks);

  [[nodiscard]] const FieldModel& model() const { return *model_; }
  [[nodiscard]] const BrickLattice& lattice() const { return model_->lattice; }
  [[nodiscard]] double band() const { return model_->band; }
  [[nodiscard]] const std::vector<double>& values() const { return value_; }
  [[nodiscard]] double value(std::uint32_t node) const { return value_[node]; }
  [[nodiscard]] bool inside(std::uint32_t node) const {
    return testBit(inside_[node / BrickLattice::brickNodes], node % BrickLattice::brickNodes);
  }
  /// Inside nodes of a brick.
  [[nodiscard]] const BrickBits& bits(std::uint32_t brick) const { return inside_[brick]; }

  /// Starts a stroke: clears the list of changes.
  void begin();
  /// Raises nodes of one row of a brick (starting at `first`) to `candidate` where that is higher, at most to the band.
  void raiseRow(std::uint32_t first, std::span<const double> candidate);
  /// Moves inside nodes of a brick outside: sets them to the band.
  void remove(std::uint32_t brick, const BrickBits& nodes);
  /// A stroke with a known result: the field becomes that of `bricks`, as after restore(), and changed() lists the
  /// changes. No commit() follows.
  /// @pre no brick is repeated
  /// @return false, without changes, if `bricks` is less carved anywhere or does not extend the bricks that led to the
  /// current field: then use restore()
  [[nodiscard]] bool raiseTo(const CarvedBricks& bricks);
  /// Ends a stroke: orders changed() and copies the changed bricks to State.
  void commit(CarvedBricks& bricks);
  /// Reserves the maximum capacity in State, so that no stroke allocates.
  void reserve(CarvedBricks& bricks) const;

  /// Bricks of this stroke with a changed value, ascending after commit().
  [[nodiscard]] std::span<const std::uint32_t> changed() const { return changed_; }
  /// Nodes of a brick whose value this stroke changed. @pre the brick is among changed()
  [[nodiscard]] const BrickBits& raised(std::uint32_t brick) const { return raised_[brick]; }
  /// Nodes of a brick that this stroke moved outside. @pre as above
  [[nodiscard]] BrickBits removed(std::uint32_t brick) const;

 private:
  void touch(std::uint32_t brick);
  void readBits(std::size_t brick);

  const FieldModel* model_;
  std::vector<double> value_;
  std::vector<BrickBits> inside_;
  std::vector<BrickBits> before_;
  std::vector<BrickBits> raised_;
  std::vector<std::uint8_t> touched_;
  std::vector<std::uint32_t> changed_;
  std::vector<std::int32_t> index_;  ///< per brick: its index in CarvedBricks; -1: none
};

// Fill of each coarse hexahedron of a carved body.

/// Coarse hexahedra of k^3 lattice cells: hexahedron h spans cells k h to k h + k - 1 along each axis. Each node
/// belongs to exactly one, along each axis to number min(n / k, last): the last of k + 1 nodes belongs to the
/// neighbour, except in the last hexahedron. The fill is the integer count of inside nodes, a function of the field
/// alone; k^3 is full.
///
/// Derived from the field; never saved. Allocates only in its constructor.
class Fill {
 public:
  /// @pre k >= 1 divides nodes() - 1 along each axis
  Fill(const BrickLattice& lattice, int k);

  [[nodiscard]] int cells() const { return k_; }
  /// Hexahedra along each axis.
  [[nodiscard]] const Index3& size() const { return size_; }
  /// Number of a hexahedron, x fastest.
  [[nodiscard]] std::uint32_t hexahedron(const Index3& h) const {
    return static_cast<std::uint32_t>(h[0] + size_[0] * (h[1] + size_[1] * h[2]));
  }
  [[nodiscard]] Index3 hexahedronOfNode(const Index3& node) const { return (node.array() / k_).min(size_.array() - 1); }
  /// Nodes that belong to a hexahedron: lower <= n < upper.
  [[nodiscard]] Index3 lower(const Index3& h) const { return k_ * h; }
  [[nodiscard]] Index3 upper(const Index3& h) const {
    return k_ * (h.array() + 1) + (h.array() == size_.array() - 1).cast<int>();
  }

  void rebuild(const CarvedField& field);
  /// Updates what the last stroke changed. @pre as CarvedSurface::update()
  void update(const CarvedField& field);

  /// Inside nodes of each hexahedron.
  [[nodiscard]] std::span<const std::int32_t> counts() const { return count_; }
  /// Hexahedra whose count the last update() or rebuild() changed, ascending.
  [[nodiscard]] std::span<const std::uint32_t> changed() const { return changed_; }

 private:
  BrickLattice lattice_;
  int k_;
  Index3 size_;
  std::vector<std::int32_t> count_;
  std::vector<std::uint8_t> marked_;
  std::vector<std::uint32_t> changed_;
};

// Carving: a tool removes the tissue that it sweeps over, in the reference configuration.

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

// Islands: parts that carving has separated from all anchors.

/// Inside nodes are connected along lattice edges (six neighbours), as in the polygons (CubeTable). A component
/// without an inside anchor node is an island. Components are stored per brick and joined in a graph of bricks. A
/// stroke relabels only bricks that lost nodes; if none of these split, lost a link to a neighbour or lost its last
/// anchor, nothing can have come loose and the graph is not searched. The result equals that of a full flood fill.
///
/// Derived from the field alone; never saved. Allocates only in its constructor.
class Islands {
 public:
  /// @param anchors nodes at which the tissue is attached, in any order, each within the lattice
  Islands(const BrickLattice& lattice, std::span<const std::uint32_t> anchors);

  /// Labels everything: at the start and after a restore.
  void rebuild(const CarvedField& field);

  /// Removes every island, within a stroke (before CarvedField::commit()). A field without a remaining anchor is
  /// removed entirely. @return number of nodes removed; times cell^3 is their volume
  std::int64_t remove(CarvedField& field);

  // Connections. Things beside the field that hang on it have numbers from 0.

  /// Finds the connected parts of the field, with `things` beside it that hang on nothing yet. Costs a search of the
  /// graph of bricks. @pre the field is that of the last rebuild() or remove()
  void connect(const CarvedField& field, std::uint32_t things);
  /// Connects a thing with the part that an inside node belongs to. @pre connect() since the field's last change
  void hang(std::uint32_t thing, std::uint32_t node) {
    join(base_.back() + thing, component(node / BrickLattice::brickNodes, node % BrickLattice::brickNodes));
  }
  /// True if two things are connected, through the field and through things that hang on several of its parts.
  [[nodiscard]] bool connected(std::uint32_t thing, std::uint32_t other) {
    return root(base_.back() + thing) == root(base_.back() + other);
  }

 private:
  void label(const CarvedField& field, std::uint32_t brick);
  void link(const CarvedField& field, std::uint32_t brick, int axis);
  bool relabel(const CarvedField& field, std::uint32_t brick);
  void markAnchored(const CarvedField& field);
  std::int64_t removeLoose(CarvedField& field);
  std::size_t component(std::uint32_t brick, std::uint32_t local) const;
  std::uint32_t root(std::size_t component);
  void join(std::size_t component, std::size_t other);
  /// The brick before or after along an axis. @return false: there is none
  bool neighbour(std::uint32_t brick, int axis, int step, std::uint32_t& out) const;

  BrickLattice lattice_;
  std::vector<std::pair<std::uint32_t, BrickBits>> anchor_;
  std::vector<std::int32_t> anchorOf_;   ///< of a brick, into anchor_; -1: none
  std::vector<std::uint8_t> hasAnchor_;  ///< per brick: does it have an inside anchor?
  std::vector<std::uint16_t> count_;     ///< components of each brick
  std::vector<std::uint8_t> link_;       ///< bit a: the brick is connected to the next along axis a
  std::vector<std::uint8_t> label_;      ///< of each node, if its brick has several components
  std::vector<std::uint32_t> base_;      ///< number of a brick's first component
  std::vector<std::uint32_t> parent_;    ///< of each component, then of each thing beside the field
  std::vector<std::uint8_t> anchored_;
  std::vector<std::uint32_t> work_;
  bool searched_ = false;  ///< since rebuild()
};

}  // namespace calot
