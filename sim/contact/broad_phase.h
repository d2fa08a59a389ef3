// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "sim/math/linear.h"
#include "sim/math/vectors.h"

namespace calot {

/// Broad phase: returns a superset of the pairs whose boxes overlap. The narrow phase decides which of them touch, and
/// pairs are sorted, so every implementation gives the same State.
class BroadPhase {
 public:
  struct Pair {
    std::uint32_t query = 0;                        ///< index into the queries
    std::uint32_t leaf = 0;                         ///< index into the leaves
    auto operator<=>(const Pair&) const = default;  // NOLINT(modernize-use-nullptr): the check's own fault
  };

  virtual ~BroadPhase() = default;

  /// Replaces the bounds of all leaves.
  virtual void update(std::span<const Box> leaves) = 0;

  /// Replaces the bounds of the leaves listed in `changed` (indices, ascending, each once). The other boxes are
  /// ignored. @pre leaves.size() is that of the last update()
  virtual void refit(std::span<const Box> leaves, std::span<const std::uint32_t> changed) {
    if (!changed.empty()) update(leaves);
  }

  /// Pairs (query, leaf), sorted, each once. @pre boxes are finite
  virtual void pairs(std::span<const Box> queries, std::vector<Pair>& out) const = 0;
};

/// Makes a broad phase; a null pointer stands for SortedGrid.
using MakeBroadPhase = std::unique_ptr<BroadPhase> (*)();

/// Eight boxes side by side, rounded outward to float; lanes that are not used are empty.
struct BoxLanes {
  alignas(32) float lower[3][laneCount];
  alignas(32) float upper[3][laneCount];
};

/// A grid of fixed cell size. Each leaf is entered into the cells that it covers, and entries are sorted by cell. A
/// leaf that covers too many cells goes to a separate list that every query tests. A refit updates only leaves whose
/// cells changed. Up to `maxSwept` leaves are tested directly, eight at a time, which is faster than a grid.
class SortedGrid final : public BroadPhase {
 public:
  /// @param cell edge of a cell (m)
  /// @param maxSwept use the grid above this number of leaves
  explicit SortedGrid(double cell, std::size_t maxSwept = 2048) : cell_(cell), maxSwept_(maxSwept) {}
  void update(std::span<const Box> leaves) override;
  void refit(std::span<const Box> leaves, std::span<const std::uint32_t> changed) override;
  void pairs(std::span<const Box> queries, std::vector<Pair>& out) const override;

 private:
  struct Entry {
    std::uint64_t cell = 0;
    std::uint32_t leaf = 0;
    auto operator<=>(const Entry&) const = default;  // NOLINT(modernize-use-nullptr)
  };
  void sweep(std::span<const Box> queries, std::vector<Pair>& out) const;
  void pack(std::size_t leaf);

  double cell_;
  std::size_t maxSwept_;
  std::vector<BoxLanes> lanes_;  ///< of the leaves, where they are swept
  std::vector<Entry> entry_;
  std::vector<std::uint32_t> large_;
  std::vector<Box> leaf_;
  std::vector<Entry> added_;
  std::vector<Entry> merged_;
  std::vector<bool> left_;
};

// Bounds rounded outward to float, so that a broad phase in single precision loses no pair.

/// Largest float not above x; minus infinity below -FLT_MAX. @pre x is a number
[[nodiscard]] inline float floatBelow(double x) {
  constexpr float largest = std::numeric_limits<float>::max();
  if (x >= static_cast<double>(largest)) return largest;
  if (x < -static_cast<double>(largest)) return -std::numeric_limits<float>::infinity();
  const auto nearest = static_cast<float>(x);
  if (static_cast<double>(nearest) <= x) return nearest;
  if (nearest == 0.0F) return -std::numeric_limits<float>::denorm_min();
  // One unit in the last place down: the magnitude's bits count up for a negative number, down for a positive one.
  const auto bits = std::bit_cast<std::uint32_t>(nearest);
  return std::bit_cast<float>(nearest > 0.0F ? bits - 1U : bits + 1U);
}

/// Smallest float not below x.
[[nodiscard]] inline float floatAbove(double x) { return -floatBelow(-x); }

/// Smallest box with float coordinates that contains this one.
[[nodiscard]] inline Box outwardBox(const Box& box) {
  Box out;
  for (int a = 0; a < 3; ++a) {
    out.lower[a] = static_cast<double>(floatBelow(box.lower[a]));
    out.upper[a] = static_cast<double>(floatAbove(box.upper[a]));
  }
  return out;
}

}  // namespace calot
