// SPDX-License-Identifier: GPL-3.0-or-later
// How much fat is left, at rest: in all, and by regions.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/fat/fat_model.h"

namespace calot {

/// Each lattice node stands for a cell's volume, of which the share clamp(1/2 - phi / cell, 0, 1) is inside: exact
/// where the surface runs along the axes, of second order elsewhere. Shares are whole 2^-20ths of a cell, so sums are
/// exact, and what was kept in step is what a full pass gives. Follows from the field; never saved.
class FatVolume {
 public:
  explicit FatVolume(const FatModel& model);

  void rebuild(const CarvedField& field);
  /// What the last stroke changed. Allocates nothing.
  void update(const CarvedField& field);

  /// m^3
  [[nodiscard]] double total() const { return unit_ * static_cast<double>(total_); }
  [[nodiscard]] double inRegion(std::size_t region) const { return unit_ * static_cast<double>(region_[region]); }

 private:
  void mark(std::uint32_t brick);
  void measure(const CarvedField& field, std::uint32_t brick);
  [[nodiscard]] BrickBits countedNodes(const CarvedField& field, std::uint32_t brick) const;

  const FatModel& model_;
  double unit_;                      ///< m^3
  std::vector<std::int64_t> brick_;  ///< (1 + regions) sums for each brick: all, then each region
  std::vector<std::uint8_t> marked_;
  std::vector<std::uint32_t> work_;
  std::int64_t total_ = 0;
  std::vector<std::int64_t> region_;
};

}  // namespace calot
