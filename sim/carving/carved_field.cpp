// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/carving/carved_field.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace calot {
namespace {

constexpr std::uint32_t brickNodes = BrickLattice::brickNodes;

/// Must a node stay outside? Padding and the lattice's border.
bool isRim(const BrickLattice& lattice, std::uint32_t node) {
  const Index3 n = lattice.nodeAt(node);
  return (n.array() <= 0).any() || (n.array() >= lattice.nodes().array() - 1).any();
}

}  // namespace

std::string FieldModel::fault() const {
  if ((lattice.nodes().array() < 2).any() || (lattice.nodes().array() > BrickLattice::maxNodes).any()) {
    return "a field needs 2 to " + std::to_string(BrickLattice::maxNodes) + " nodes along each axis";
  }
  if (!(band > 0.0)) return "the band of a field must be positive";
  if (value.size() != lattice.storage()) return "a field needs one value for each node";
  for (std::size_t n = 0; n < value.size(); ++n) {
    if (!(std::abs(value[n]) <= band)) return "value " + std::to_string(n) + " is not within the band";
    if (value[n] < 0.0 && isRim(lattice, static_cast<std::uint32_t>(n))) {
      return "the body reaches the lattice's border";
    }
  }
  return {};
}

CarvedField::CarvedField(const FieldModel& model)
    : model_(&model),
      value_(model.value),
      inside_(model.lattice.brickCount()),
      before_(model.lattice.brickCount()),
      raised_(model.lattice.brickCount()),
      touched_(model.lattice.brickCount(), 0),
      index_(model.lattice.brickCount(), -1) {
  assert(model.fault().empty());
  changed_.reserve(inside_.size());
  for (std::size_t b = 0; b < inside_.size(); ++b) readBits(b);
}

void CarvedField::readBits(std::size_t brick) {
  const double* value = value_.data() + brick * brickNodes;
  for (std::size_t z = 0; z < 8; ++z) {
    std::uint64_t layer = 0;
    for (unsigned i = 0; i < 64; ++i) layer |= static_cast<std::uint64_t>(value[64 * z + i] < 0.0) << i;
    inside_[brick][z] = layer;
  }
}

bool CarvedField::restore(const CarvedBricks& bricks) {
  begin();
  value_ = model_->value;
  std::fill(index_.begin(), index_.end(), -1);
  bool good = bricks.brick.size() == bricks.value.size();
  for (std::size_t i = 0; good && i < bricks.brick.size(); ++i) {
    const std::uint32_t b = bricks.brick[i];
    good = b < inside_.size() && index_[b] < 0;
    if (!good) break;
    index_[b] = static_cast<std::int32_t>(i);
    for (std::uint32_t k = 0; good && k < brickNodes; ++k) {
      const double v = bricks.value[i][k];
      good = std::abs(v) <= model_->band && !(v < 0.0 && isRim(lattice(), b * brickNodes + k));
    }
    if (good) std::copy(bricks.value[i].begin(), bricks.value[i].end(), value_.begin() + b * brickNodes);
  }
  if (!good) {
    value_ = model_->value;
    std::fill(index_.begin(), index_.end(), -1);
  }
  for (std::size_t b = 0; b < inside_.size(); ++b) readBits(b);
  return good;
}

bool CarvedField::raiseTo(const CarvedBricks& bricks) {
  if (bricks.brick.size() != bricks.value.size()) return false;
  std::size_t known = 0;
  for (std::size_t i = 0; i < bricks.brick.size(); ++i) {
    const std::uint32_t b = bricks.brick[i];
    if (b >= inside_.size() || (index_[b] >= 0 && slot(index_[b]) != i)) return false;
    known += index_[b] >= 0 ? 1 : 0;
    const double* here = value_.data() + std::size_t{b} * brickNodes;
    for (std::uint32_t k = 0; k < brickNodes; ++k) {
      if (!(bricks.value[i][k] >= here[k] && bricks.value[i][k] <= band())) return false;
    }
  }
  // No carved brick may be missing.
  const auto placed = std::count_if(index_.begin(), index_.end(), [](std::int32_t p) { return p >= 0; });
  if (known != static_cast<std::size_t>(placed)) return false;
  begin();
  for (std::size_t i = 0; i < bricks.brick.size(); ++i) {
    const std::uint32_t b = bricks.brick[i];
    index_[b] = static_cast<std::int32_t>(i);
    for (std::uint32_t row = 0; row < brickNodes; row += BrickLattice::side)
      raiseRow(b * brickNodes + row, std::span(bricks.value[i]).subspan(row, BrickLattice::side));
  }
  std::sort(changed_.begin(), changed_.end());
  return true;
}

void CarvedField::begin() {
  for (const std::uint32_t b : changed_) touched_[b] = 0;
  changed_.clear();
}

void CarvedField::touch(std::uint32_t brick) {
  if (touched_[brick] != 0) return;
  touched_[brick] = 1;
  before_[brick] = inside_[brick];
  raised_[brick] = {};
  changed_.push_back(brick);
}

void CarvedField::raiseRow(std::uint32_t first, std::span<const double> candidate) {
  double* value = value_.data() + first;
  bool higher = false;
  for (std::size_t i = 0; i < candidate.size(); ++i) higher = higher || std::min(candidate[i], band()) > value[i];
  if (!higher) return;
  const std::uint32_t brick = first / brickNodes;
  touch(brick);
  const std::uint32_t local = first % brickNodes;
  std::uint64_t outside = 0;
  std::uint64_t raised = 0;
  for (std::size_t i = 0; i < candidate.size(); ++i) {
    const double target = std::min(candidate[i], band());
    raised |= static_cast<std::uint64_t>(target > value[i]) << i;
    value[i] = std::max(value[i], target);
    outside |= static_cast<std::uint64_t>(!(value[i] < 0.0)) << i;
  }
  inside_[brick][local >> 6U] &= ~(outside << (local & 63U));
  raised_[brick][local >> 6U] |= raised << (local & 63U);
}

void CarvedField::remove(std::uint32_t brick, const BrickBits& nodes) {
  touch(brick);
  double* value = value_.data() + std::size_t{brick} * brickNodes;
  forEachBit(nodes, [&](std::uint32_t local) { value[local] = band(); });
  for (std::size_t z = 0; z < 8; ++z) {
    inside_[brick][z] &= ~nodes[z];
    raised_[brick][z] |= nodes[z];
  }
}

BrickBits CarvedField::removed(std::uint32_t brick) const {
  BrickBits out;
  for (std::size_t z = 0; z < 8; ++z) out[z] = before_[brick][z] & ~inside_[brick][z];
  return out;
}

void CarvedField::commit(CarvedBricks& bricks) {
  std::sort(changed_.begin(), changed_.end());
  for (const std::uint32_t b : changed_) {
    if (index_[b] < 0) {
      index_[b] = static_cast<std::int32_t>(bricks.brick.size());
      bricks.brick.push_back(b);
      bricks.value.emplace_back();
    }
    const double* value = value_.data() + std::size_t{b} * brickNodes;
    std::copy(value, value + brickNodes, bricks.value[slot(index_[b])].begin());
  }
}

void CarvedField::reserve(CarvedBricks& bricks) const {
  // Values only rise, up to the band: a brick entirely at the band never changes.
  std::size_t maximum = 0;
  for (std::size_t b = 0; b < inside_.size(); ++b) {
    const double* value = model_->value.data() + b * brickNodes;
    maximum += std::any_of(value, value + brickNodes, [this](double v) { return v < band(); }) ? 1 : 0;
  }
  bricks.brick.reserve(maximum);
  bricks.value.reserve(maximum);
}

Fill::Fill(const BrickLattice& lattice, int k) : lattice_(lattice), k_(k), size_((lattice.nodes().array() - 1) / k) {
  assert(k >= 1 && (size_ * k + Index3::Ones() - lattice.nodes()).isZero());
  const std::size_t n = slot(size_[0]) * slot(size_[1]) * slot(size_[2]);
  count_.assign(n, 0);
  marked_.assign(n, 0);
  changed_.reserve(n);
}

void Fill::rebuild(const CarvedField& field) {
  std::fill(count_.begin(), count_.end(), 0);
  for (std::uint32_t b = 0; b < lattice_.brickCount(); ++b) {
    forEachBit(field.bits(b), [&](std::uint32_t local) {
      ++count_[hexahedron(hexahedronOfNode(lattice_.nodeAt(b * BrickLattice::brickNodes + local)))];
    });
  }
  changed_.clear();
  for (std::uint32_t h = 0; h < count_.size(); ++h) changed_.push_back(h);
}

void Fill::update(const CarvedField& field) {
  changed_.clear();
  for (const std::uint32_t b : field.changed()) {
    const Index3 origin = 8 * lattice_.brickAt(b);
    forEachBit(field.removed(b), [&](std::uint32_t local) {
      const auto l = static_cast<int>(local);
      const std::uint32_t h = hexahedron(hexahedronOfNode(origin + Index3(l & 7, l >> 3 & 7, l >> 6)));
      --count_[h];
      if (marked_[h] == 0) changed_.push_back(h);
      marked_[h] = 1;
    });
  }
  for (const std::uint32_t h : changed_) marked_[h] = 0;
  std::sort(changed_.begin(), changed_.end());
}

}  // namespace calot
