// SPDX-License-Identifier: GPL-3.0-or-later
// A regular lattice of nodes with values stored brick by brick.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "sim/geometry/triangle_mesh.h"
#include "sim/math/linear.h"

namespace calot {

/// Calls visit(n) for each n from `first` to `last` (both included), the first component running fastest.
template <class Visit>
void forEachIndex(const Index3& first, const Index3& last, Visit&& visit) {
  Index3 n;
  for (n[2] = first[2]; n[2] <= last[2]; ++n[2]) {
    for (n[1] = first[1]; n[1] <= last[1]; ++n[1]) {
      for (n[0] = first[0]; n[0] <= last[0]; ++n[0]) visit(n);
    }
  }
}

/// Nodes at origin + cell (i, j, k), 0 <= i < nodes[0] and so on, in bricks of 8^3 nodes: neighbours in space are close
/// in memory, and bricks are the unit of change, saving and hashing.
///
/// The index of a node is brick * 512 + x + 8 (y + 8 z) with x, y, z its position in the brick; bricks are numbered
/// with x fastest. If nodes[a] is not a multiple of 8, bricks are padded: padding has indices and values (outside).
///
/// The cell of a node is the cube whose lowest corner it is.
class BrickLattice {
 public:
  static constexpr int side = 8;           ///< nodes along a brick
  static constexpr int brickNodes = 512;   ///< side^3
  static constexpr int maxNodes = 1 << 9;  ///< along an axis: every index used below fits 32 bits

  BrickLattice() = default;
  /// @param origin node (0, 0, 0) (m) @param cell distance of neighbours (m) @param nodes along each axis
  /// @pre cell > 0, 2 <= nodes <= maxNodes
  BrickLattice(const Vec3& origin, double cell, const Index3& nodes)
      : origin_(origin), cell_(cell), nodes_(nodes), bricks_((nodes.array() + (side - 1)) / side) {}

  /// Smallest lattice with at least `margin` cells around the box and node counts that are a multiple
  /// of `multiple` plus one.
  /// @pre cell > 0, the box not empty, multiple >= 1
  static BrickLattice around(const Box& box, double cell, int margin, int multiple = 1) {
    Index3 nodes;
    for (int a = 0; a < 3; ++a) {
      const double span = std::min(notNegative((box.upper[a] - box.lower[a]) / cell), 1e6);
      int cells = 2 * margin + static_cast<int>(span) + 1;
      cells = (cells + multiple - 1) / multiple * multiple;
      nodes[a] = cells + 1;
    }
    const Vec3 middle = 0.5 * (box.lower + box.upper);
    const Vec3 half = 0.5 * cell * (nodes.array() - 1).cast<double>().matrix();
    return {middle - half, cell, nodes};
  }

  [[nodiscard]] const Vec3& origin() const { return origin_; }
  [[nodiscard]] double cell() const { return cell_; }
  [[nodiscard]] const Index3& nodes() const { return nodes_; }
  [[nodiscard]] const Index3& bricks() const { return bricks_; }
  [[nodiscard]] std::size_t brickCount() const { return slot(bricks_[0]) * slot(bricks_[1]) * slot(bricks_[2]); }
  /// Values of all bricks, padding included.
  [[nodiscard]] std::size_t storage() const { return brickCount() * brickNodes; }

  [[nodiscard]] bool contains(const Index3& n) const {
    return (n.array() >= 0).all() && (n.array() < nodes_.array()).all();
  }
  [[nodiscard]] std::uint32_t brick(const Index3& b) const {
    return static_cast<std::uint32_t>(b[0] + bricks_[0] * (b[1] + bricks_[1] * b[2]));
  }
  [[nodiscard]] Index3 brickAt(std::uint32_t brick) const {
    const int b = static_cast<int>(brick);
    return {b % bricks_[0], b / bricks_[0] % bricks_[1], b / bricks_[0] / bricks_[1]};
  }
  /// Index of a node. @pre 0 <= n < 8 bricks()
  [[nodiscard]] std::uint32_t node(const Index3& n) const {
    const std::uint32_t b = brick({n[0] >> 3, n[1] >> 3, n[2] >> 3});
    return b * brickNodes + static_cast<std::uint32_t>((n[0] & 7) + side * ((n[1] & 7) + side * (n[2] & 7)));
  }
  [[nodiscard]] Index3 nodeAt(std::uint32_t node) const {
    const int local = static_cast<int>(node % brickNodes);
    return side * brickAt(node / brickNodes) + Index3(local & 7, (local >> 3) & 7, local >> 6);
  }
  /// The next node along +axis, the one before it along -axis. @pre it is within bricks(): ask for no node beyond
  [[nodiscard]] std::uint32_t next(std::uint32_t node, int axis) const {
    const std::uint32_t step = 1U << static_cast<unsigned>(3 * axis);
    return (node / step & 7U) < 7 ? node + step : node + brickStep(axis) - 7 * step;
  }
  [[nodiscard]] std::uint32_t previous(std::uint32_t node, int axis) const {
    const std::uint32_t step = 1U << static_cast<unsigned>(3 * axis);
    return (node / step & 7U) > 0 ? node - step : node - brickStep(axis) + 7 * step;
  }
  /// m
  [[nodiscard]] Vec3 position(const Index3& n) const { return origin_ + cell_ * n.cast<double>(); }

 private:
  /// Index increment from one brick to the next along an axis.
  [[nodiscard]] std::uint32_t brickStep(int axis) const {
    const int bricks = axis == 0 ? 1 : (axis == 1 ? bricks_[0] : bricks_[0] * bricks_[1]);
    return static_cast<std::uint32_t>(bricks) * brickNodes;
  }

  Vec3 origin_ = Vec3::Zero();
  double cell_ = 1.0;
  Index3 nodes_ = Index3::Zero();
  Index3 bricks_ = Index3::Zero();
};

}  // namespace calot
