// SPDX-License-Identifier: GPL-3.0-or-later
// Remaining volume of fat in the reference configuration: in total and by regions.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/fat/fat_model.h"

namespace calot {

/// Each lattice node represents a cell's volume, of which the share clamp(1/2 - phi / cell, 0, 1) is inside: exact for
/// surfaces parallel to the axes, second-order accurate elsewhere. Shares are multiples of 2^-20 of a cell, so that
/// sums are exact and incremental updates equal a full pass. Derived from the field; never saved.
class FatVolume {
 public:
  explicit FatVolume(const FatModel& model);

  void rebuild(const CarvedField& field);
  /// Updates what the last stroke changed. Allocates nothing.
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
