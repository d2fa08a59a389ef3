// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/math/lanes.h"
#include "sim/math/linear.h"

namespace calot {

/// Answers one question, "which pairs may touch?", with a superset of the pairs whose boxes overlap; the narrow phase
/// decides. Any implementation gives the same State, since pairs are sorted and decided again.
class BroadPhase {
 public:
  struct Pair {
    std::uint32_t query = 0;                        ///< index into the queries
    std::uint32_t leaf = 0;                         ///< index into the leaves
    auto operator<=>(const Pair&) const = default;  // NOLINT(modernize-use-nullptr): the check's own fault
  };

  virtual ~BroadPhase() = default;

  /// Takes new bounds of all leaves.
  virtual void update(std::span<const Box> leaves) = 0;

  /// Takes new bounds of the leaves named in `changed` (indices, ascending, each once); what the others' boxes are is
  /// not looked at. @pre leaves.size() is that of the last update()
  virtual void refit(std::span<const Box> leaves, std::span<const std::uint32_t> changed) {
    if (!changed.empty()) update(leaves);
  }

  /// Pairs (query, leaf), sorted, each once. @pre boxes are finite
  virtual void pairs(std::span<const Box> queries, std::vector<Pair>& out) const = 0;
};

/// Eight boxes side by side, rounded outward to float; lanes that are not used are empty.
struct BoxLanes {
  alignas(32) float lower[3][laneCount];
  alignas(32) float upper[3][laneCount];
};

/// Cells of a fixed size; each leaf enters the cells that it covers, entries are sorted by cell. A leaf that covers too
/// many cells is kept in a list of its own and offered to every query. A refit touches only leaves that came to cover
/// other cells. Up to `mostSwept` leaves need no cells: asking all of them, eight at a time, is quicker.
class SortedGrid final : public BroadPhase {
 public:
  /// @param cell edge of a cell (m)
  /// @param mostSwept see above
  explicit SortedGrid(double cell, std::size_t mostSwept = 2048) : cell_(cell), mostSwept_(mostSwept) {}
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
  std::size_t mostSwept_;
  std::vector<BoxLanes> lanes_;  ///< of the leaves, where they are swept
  std::vector<Entry> entry_;
  std::vector<std::uint32_t> large_;
  std::vector<Box> leaf_;
  std::vector<Entry> added_;
  std::vector<Entry> merged_;
  std::vector<bool> left_;
};

}  // namespace calot
