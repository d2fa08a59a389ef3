// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/carving/carved_field.h"

#include <algorithm>

namespace calot {
namespace {

constexpr std::uint32_t nodesOfBrick = BrickLattice::brickNodes;
constexpr std::size_t maxComponents = 256;  // of a brick: every other node

/// Component of the lowest node of `open`.
BrickBits lowestComponent(const BrickBits& open) {
  BrickBits part{};
  for (std::size_t z = 0; z < 8; ++z) {
    if (open[z] == 0) continue;
    part[z] = open[z] & (~open[z] + 1);
    break;
  }
  for (;;) {
    BrickBits grown = dilated(part);
    std::uint64_t change = 0;
    for (std::size_t z = 0; z < 8; ++z) {
      grown[z] &= open[z];
      // Also propagate upward within the same pass: most bodies are then filled in two or three passes.
      if (z > 0) grown[z] |= grown[z - 1] & open[z];
    }
    for (std::size_t z = 7; z-- > 0;) grown[z] |= grown[z + 1] & open[z];
    for (std::size_t z = 0; z < 8; ++z) change |= grown[z] ^ part[z];
    if (change == 0) return part;
    part = grown;
  }
}

}  // namespace

Islands::Islands(const BrickLattice& lattice, std::span<const std::uint32_t> anchors)
    : lattice_(lattice),
      anchorOf_(lattice.brickCount(), -1),
      hasAnchor_(lattice.brickCount(), 0),
      count_(lattice.brickCount(), 0),
      link_(lattice.brickCount(), 0),
      label_(lattice.storage(), 0),
      base_(lattice.brickCount() + 1, 0) {
  std::vector<std::uint32_t> sorted(anchors.begin(), anchors.end());
  std::sort(sorted.begin(), sorted.end());
  for (const std::uint32_t node : sorted) {
    const std::uint32_t brick = node / nodesOfBrick;
    if (anchor_.empty() || anchor_.back().first != brick) {
      anchorOf_[brick] = static_cast<std::int32_t>(anchor_.size());
      anchor_.push_back({brick, BrickBits{}});
    }
    const std::uint32_t local = node % nodesOfBrick;
    anchor_.back().second[local >> 6U] |= std::uint64_t{1} << (local & 63U);
  }
  parent_.reserve(maxComponents * lattice.brickCount());
  anchored_.reserve(maxComponents * lattice.brickCount());
  work_.reserve(lattice.brickCount());
}

bool Islands::neighbour(std::uint32_t brick, int axis, int step, std::uint32_t& out) const {
  Index3 b = lattice_.brickAt(brick);
  b[axis] += step;
  if (b[axis] < 0 || b[axis] >= lattice_.bricks()[axis]) return false;
  out = lattice_.brick(b);
  return true;
}

void Islands::label(const CarvedField& field, std::uint32_t brick) {
  BrickBits open = field.bits(brick);
  std::uint16_t count = 0;
  std::uint8_t* label = label_.data() + std::size_t{brick} * nodesOfBrick;
  while (anyBit(open)) {
    const BrickBits part = lowestComponent(open);
    for (std::size_t z = 0; z < 8; ++z) open[z] &= ~part[z];
    // The common case, one component, needs no labels.
    if (count > 0 || anyBit(open)) {
      forEachBit(part, [label, count](std::uint32_t local) { label[local] = static_cast<std::uint8_t>(count); });
    }
    ++count;
  }
  count_[brick] = count;
  hasAnchor_[brick] = 0;
  if (anchorOf_[brick] < 0) return;
  BrickBits held = anchor_[slot(anchorOf_[brick])].second;
  for (std::size_t z = 0; z < 8; ++z) held[z] &= field.bits(brick)[z];
  hasAnchor_[brick] = anyBit(held) ? 1 : 0;
}

void Islands::link(const CarvedField& field, std::uint32_t brick, int axis) {
  std::uint32_t other = 0;
  const auto bit = static_cast<std::uint8_t>(1U << static_cast<unsigned>(axis));
  link_[brick] = static_cast<std::uint8_t>(link_[brick] & ~bit);
  if (!neighbour(brick, axis, 1, other)) return;
  if (sharedFace(field.bits(brick), field.bits(other), axis) != 0) link_[brick] |= bit;
}

/// @return false: connections through this brick and its anchoring are unchanged
bool Islands::relabel(const CarvedField& field, std::uint32_t brick) {
  const bool whole = count_[brick] == 1;
  const bool held = hasAnchor_[brick] != 0;
  label(field, brick);
  bool less = !whole || count_[brick] != 1 || (held && hasAnchor_[brick] == 0);
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint8_t links = link_[brick];
    link(field, brick, axis);
    less = less || links != link_[brick];
    std::uint32_t before = 0;
    if (!neighbour(brick, axis, -1, before)) continue;
    const std::uint8_t linksBefore = link_[before];
    link(field, before, axis);
    // A neighbour with several components may have lost the link of one.
    less = less || linksBefore != link_[before] || count_[before] > 1;
  }
  for (int axis = 0; axis < 3; ++axis) {
    std::uint32_t after = 0;
    less = less || (neighbour(brick, axis, 1, after) && count_[after] > 1);
  }
  return less;
}

void Islands::rebuild(const CarvedField& field) {
  const auto bricks = static_cast<std::uint32_t>(lattice_.brickCount());
  for (std::uint32_t b = 0; b < bricks; ++b) {
    label(field, b);
    for (int axis = 0; axis < 3; ++axis) link(field, b, axis);
  }
  searched_ = false;
}

std::size_t Islands::component(std::uint32_t brick, std::uint32_t local) const {
  return base_[brick] + (count_[brick] > 1 ? label_[std::size_t{brick} * nodesOfBrick + local] : 0U);
}

std::uint32_t Islands::root(std::size_t component) {
  auto c = static_cast<std::uint32_t>(component);
  while (parent_[c] != c) c = parent_[c] = parent_[parent_[c]];
  return c;
}

void Islands::join(std::size_t component, std::size_t other) {
  const std::uint32_t a = root(component);
  const std::uint32_t b = root(other);
  parent_[std::max(a, b)] = std::min(a, b);
}

void Islands::connect(const CarvedField& field, std::uint32_t things) {
  const std::size_t bricks = lattice_.brickCount();
  for (std::size_t b = 0; b < bricks; ++b) base_[b + 1] = base_[b] + count_[b];
  parent_.resize(base_[bricks] + things);
  for (std::uint32_t c = 0; c < parent_.size(); ++c) parent_[c] = c;
  const Index3& size = lattice_.bricks();
  const std::array<std::uint32_t, 3> step{1, static_cast<std::uint32_t>(size[0]),
                                          static_cast<std::uint32_t>(size[0] * size[1])};
  for (std::uint32_t b = 0; b < bricks; ++b) {
    for (int axis = 0; axis < 3; ++axis) {
      if ((link_[b] >> static_cast<unsigned>(axis) & 1U) == 0) continue;  // at a border there is none
      const std::uint32_t other = b + step[slot(axis)];
      if (count_[b] == 1 && count_[other] == 1) {
        join(base_[b], base_[other]);
        continue;
      }
      for (std::uint64_t face = sharedFace(field.bits(b), field.bits(other), axis); face != 0; face &= face - 1) {
        const FacePair pair = facePair(static_cast<unsigned>(std::countr_zero(face)), axis);
        join(component(b, pair.a), component(other, pair.b));
      }
    }
  }
}

void Islands::markAnchored(const CarvedField& field) {
  anchored_.assign(parent_.size(), 0);
  for (const auto& [brick, nodes] : anchor_) {
    const std::uint32_t b = brick;
    if (hasAnchor_[b] == 0) continue;
    if (count_[b] == 1) {
      anchored_[root(base_[b])] = 1;
      continue;
    }
    BrickBits held = field.bits(b);
    for (std::size_t z = 0; z < 8; ++z) held[z] &= nodes[z];
    forEachBit(held, [this, b](std::uint32_t local) { anchored_[root(component(b, local))] = 1; });
  }
}

std::int64_t Islands::removeLoose(CarvedField& field) {
  std::int64_t removed = 0;
  work_.clear();
  for (std::uint32_t b = 0; b < lattice_.brickCount(); ++b) {
    bool loose = false;
    for (std::uint32_t c = base_[b]; c < base_[b + 1]; ++c) loose = loose || anchored_[root(c)] == 0;
    if (!loose) continue;
    BrickBits nodes{};
    forEachBit(field.bits(b), [&](std::uint32_t local) {
      if (anchored_[root(component(b, local))] == 0) nodes[local >> 6U] |= std::uint64_t{1} << (local & 63U);
    });
    removed += countBits(nodes);
    field.remove(b, nodes);
    work_.push_back(b);
  }
  for (const std::uint32_t b : work_) relabel(field, b);
  return removed;
}

std::int64_t Islands::remove(CarvedField& field) {
  bool less = !searched_;
  for (const std::uint32_t b : field.changed()) {
    if (anyBit(field.removed(b))) less = relabel(field, b) || less;
  }
  if (!less) return 0;
  searched_ = true;
  connect(field, 0);
  markAnchored(field);
  return removeLoose(field);
}

}  // namespace calot
