// SPDX-License-Identifier: GPL-3.0-or-later
// A body as the inside (value < 0) of a potential field on a lattice: the original, the changes and a working copy.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/geometry/brick_lattice.h"

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

}  // namespace calot
