// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/fat/fat_volume.h"

#include <algorithm>
#include <array>

#include "sim/math/bounds.h"

namespace calot {

namespace {
constexpr double unitsOfCell = 1048576.0;
}  // namespace

FatVolume::FatVolume(const FatModel& model)
    : model_(model),
      unit_(model.lattice().cell() * (model.lattice().cell() * model.lattice().cell()) / unitsOfCell),
      brick_((1 + model.regions()) * model.lattice().brickCount(), 0),
      marked_(model.lattice().brickCount(), 0),
      region_(model.regions(), 0) {
  work_.reserve(marked_.size());
}

void FatVolume::rebuild(const CarvedField& field) {
  std::fill(brick_.begin(), brick_.end(), 0);
  std::fill(region_.begin(), region_.end(), 0);
  total_ = 0;
  for (std::uint32_t b = 0; b < model_.lattice().brickCount(); ++b) measure(field, b);
}

void FatVolume::update(const CarvedField& field) {
  work_.clear();
  for (const std::uint32_t b : field.changed()) {
    mark(b);
    if (!anyBit(field.removed(b))) continue;
    const Index3 at = model_.lattice().brickAt(b);
    for (int a = 0; a < 3; ++a) {
      if (at[a] > 0) mark(model_.lattice().brick(at - Index3::Unit(a)));
      if (at[a] + 1 < model_.lattice().bricks()[a]) mark(model_.lattice().brick(at + Index3::Unit(a)));
    }
  }
  for (const std::uint32_t b : work_) {
    marked_[b] = 0;
    measure(field, b);
  }
}

void FatVolume::mark(std::uint32_t brick) {
  if (marked_[brick] == 0) work_.push_back(brick);
  marked_[brick] = 1;
}

/// Inside nodes of a brick and their neighbours.
BrickBits FatVolume::countedNodes(const CarvedField& field, std::uint32_t brick) const {
  const BrickLattice& lattice = model_.lattice();
  BrickBits bits = dilated(field.bits(brick));
  const Index3 at = lattice.brickAt(brick);
  const auto beside = [&](int axis, int step) -> const BrickBits* {
    const int there = at[axis] + step;
    if (there < 0 || there >= lattice.bricks()[axis]) return nullptr;
    return &field.bits(lattice.brick(at + step * Index3::Unit(axis)));
  };
  if (const BrickBits* b = beside(0, -1)) {
    for (std::size_t z = 0; z < 8; ++z) bits[z] |= ((*b)[z] & columnLast) >> 7U;
  }
  if (const BrickBits* b = beside(0, 1)) {
    for (std::size_t z = 0; z < 8; ++z) bits[z] |= ((*b)[z] & columnFirst) << 7U;
  }
  if (const BrickBits* b = beside(1, -1)) {
    for (std::size_t z = 0; z < 8; ++z) bits[z] |= (*b)[z] >> 56U;
  }
  if (const BrickBits* b = beside(1, 1)) {
    for (std::size_t z = 0; z < 8; ++z) bits[z] |= (*b)[z] << 56U;
  }
  if (const BrickBits* b = beside(2, -1)) bits[0] |= (*b)[7];
  if (const BrickBits* b = beside(2, 1)) bits[7] |= (*b)[0];
  return bits;
}

void FatVolume::measure(const CarvedField& field, std::uint32_t brick) {
  constexpr std::uint32_t nodes = BrickLattice::brickNodes;
  const double* value = field.values().data() + std::size_t{nodes} * brick;
  const double cell = model_.lattice().cell();
  const BrickBits counted = countedNodes(field, brick);
  std::array<std::int32_t, nodes> units{};
  std::int64_t sum = 0;
  if (anyBit(counted)) {
    for (std::uint32_t i = 0; i < nodes; ++i) {
      const double share = std::min(notNegative(0.5 - value[i] / cell), 1.0);
      units[i] = testBit(counted, i) ? static_cast<std::int32_t>(unitsOfCell * share) : 0;
      sum += units[i];
    }
  }
  std::int64_t* kept = brick_.data() + (1 + model_.regions()) * brick;
  total_ += sum - kept[0];
  kept[0] = sum;
  for (std::size_t r = 0; r < model_.regions(); ++r) {
    std::int64_t in = 0;
    forEachBit(model_.region(r)[brick], [&](std::uint32_t local) { in += units[local]; });
    region_[r] += in - kept[1 + r];
    kept[1 + r] = in;
  }
}

}  // namespace calot
