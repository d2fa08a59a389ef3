// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/carving/fill.h"

#include <algorithm>
#include <cassert>

namespace calot {

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
