// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "sim/contact/broad_phase.h"

namespace calot {

namespace {

constexpr std::int64_t largestCell = 1 << 20;
constexpr std::int64_t mostCells = 512;

/// Cell index along one axis, clamped; 21 bits each make one key.
std::int64_t cellOf(double x, double cell) {
  const double scaled = std::floor(x / cell);
  return static_cast<std::int64_t>(
      std::clamp(scaled, -static_cast<double>(largestCell), static_cast<double>(largestCell - 1)));
}

std::uint64_t key(std::int64_t i, std::int64_t j, std::int64_t k) {
  const auto part = [](std::int64_t v) { return static_cast<std::uint64_t>(v + largestCell); };
  return (part(i) << 42U) | (part(j) << 21U) | part(k);
}

struct CellRange {
  std::int64_t lower[3];
  std::int64_t upper[3];
  [[nodiscard]] std::int64_t count() const {
    // Each factor is below 2^21, and the product is cut off long before it could overflow.
    std::int64_t n = 1;
    for (int a = 0; a < 3; ++a) n = std::min<std::int64_t>(n * (upper[a] - lower[a] + 1), std::int64_t{1} << 40U);
    return n;
  }
};

CellRange cellsOf(const Box& box, double cell) {
  CellRange range{};
  for (int a = 0; a < 3; ++a) {
    range.lower[a] = cellOf(box.lower[a], cell);
    range.upper[a] = cellOf(box.upper[a], cell);
  }
  return range;
}

template <class F>
void forEachCell(const CellRange& range, F&& f) {
  for (std::int64_t i = range.lower[0]; i <= range.upper[0]; ++i) {
    for (std::int64_t j = range.lower[1]; j <= range.upper[1]; ++j) {
      for (std::int64_t k = range.lower[2]; k <= range.upper[2]; ++k) f(key(i, j, k));
    }
  }
}

}  // namespace

void SortedGrid::update(std::span<const Box> leaves) {
  leaf_.assign(leaves.begin(), leaves.end());
  entry_.clear();
  large_.clear();
  for (std::uint32_t l = 0; l < leaf_.size(); ++l) {
    const CellRange range = cellsOf(leaf_[l], cell_);
    if (range.count() > mostCells) {
      large_.push_back(l);
      continue;
    }
    forEachCell(range, [&](std::uint64_t c) { entry_.push_back({c, l}); });
  }
  std::sort(entry_.begin(), entry_.end());
}

void SortedGrid::refit(std::span<const Box> leaves, std::span<const std::uint32_t> changed) {
  added_.clear();
  left_.assign(leaf_.size(), false);
  for (const std::uint32_t l : changed) {
    const CellRange before = cellsOf(leaf_[l], cell_);
    const CellRange after = cellsOf(leaves[l], cell_);
    leaf_[l] = leaves[l];
    if (std::equal(before.lower, before.lower + 3, after.lower) &&
        std::equal(before.upper, before.upper + 3, after.upper)) {
      continue;
    }
    left_[l] = true;
    if (before.count() > mostCells) large_.erase(std::lower_bound(large_.begin(), large_.end(), l));
    if (after.count() > mostCells) {
      large_.insert(std::lower_bound(large_.begin(), large_.end(), l), l);
    } else {
      forEachCell(after, [&](std::uint64_t c) { added_.push_back({c, l}); });
    }
  }
  if (std::find(left_.begin(), left_.end(), true) == left_.end()) return;
  std::sort(added_.begin(), added_.end());
  merged_.clear();
  auto next = added_.begin();
  for (const Entry& e : entry_) {
    if (left_[e.leaf]) continue;
    for (; next != added_.end() && *next < e; ++next) merged_.push_back(*next);
    merged_.push_back(e);
  }
  merged_.insert(merged_.end(), next, added_.end());
  entry_.swap(merged_);
}

void SortedGrid::pairs(std::span<const Box> queries, std::vector<Pair>& out) const {
  out.clear();
  for (std::uint32_t q = 0; q < queries.size(); ++q) {
    const std::size_t start = out.size();
    const auto offer = [&](std::uint32_t l) {
      if (queries[q].overlaps(leaf_[l])) out.push_back({q, l});
    };
    const CellRange range = cellsOf(queries[q], cell_);
    if (range.count() > static_cast<std::int64_t>(entry_.size())) {
      for (std::uint32_t l = 0; l < leaf_.size(); ++l) offer(l);
      continue;
    }
    for (const std::uint32_t l : large_) offer(l);
    forEachCell(range, [&](std::uint64_t c) {
      for (auto e = std::lower_bound(entry_.begin(), entry_.end(), Entry{c, 0}); e != entry_.end() && e->cell == c;
           ++e) {
        offer(e->leaf);
      }
    });
    std::sort(out.begin() + static_cast<std::ptrdiff_t>(start), out.end());
    out.erase(std::unique(out.begin() + static_cast<std::ptrdiff_t>(start), out.end()), out.end());
  }
}

}  // namespace calot
