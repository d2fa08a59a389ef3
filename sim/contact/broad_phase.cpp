// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/broad_phase.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "sim/math/vectors.h"

namespace calot {

namespace {

constexpr std::int64_t maxCellIndex = 1 << 20;
constexpr std::int64_t maxCells = 512;

/// Cell index along one axis, clamped; 21 bits each make one key.
std::int64_t cellOf(double x, double cell) {
  const double scaled = std::floor(x / cell);
  return static_cast<std::int64_t>(
      std::clamp(scaled, -static_cast<double>(maxCellIndex), static_cast<double>(maxCellIndex - 1)));
}

std::uint64_t key(std::int64_t i, std::int64_t j, std::int64_t k) {
  const auto part = [](std::int64_t v) { return static_cast<std::uint64_t>(v + maxCellIndex); };
  return (part(i) << 42U) | (part(j) << 21U) | part(k);
}

struct CellRange {
  std::int64_t lower[3];
  std::int64_t upper[3];
  [[nodiscard]] std::int64_t count() const {
    // Each factor is below 2^21, and the loop ends long before the product could overflow.
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

/// First group at or after `first` with a box that overlaps the query, and a bit for each such lane.
CALOT_LANE_KERNEL std::size_t nextOverlap(const BoxLanes* group, std::size_t first, std::size_t last,
                                          const float* lower, const float* upper, std::int32_t* hit) {
  for (std::size_t g = first; g < last; ++g) {
    EightInts in = EightInts{} - 1;
    for (std::size_t a = 0; a < 3; ++a) {
      EightFloats low;
      EightFloats high;
      readVector(group[g].lower[a], low);
      readVector(group[g].upper[a], high);
      in &= (low <= upper[a]) & (lower[a] <= high);
    }
    std::uint64_t any[4];
    std::memcpy(any, &in, sizeof any);
    if (((any[0] | any[1]) | (any[2] | any[3])) == 0) continue;
    writeVector(in, hit);
    return g;
  }
  return last;
}

}  // namespace

void SortedGrid::pack(std::size_t leaf) {
  BoxLanes& group = lanes_[leaf / laneCount];
  for (int a = 0; a < 3; ++a) {
    group.lower[a][leaf % laneCount] = floatBelow(leaf_[leaf].lower[a]);
    group.upper[a][leaf % laneCount] = floatAbove(leaf_[leaf].upper[a]);
  }
}

void SortedGrid::sweep(std::span<const Box> queries, std::vector<Pair>& out) const {
  for (std::uint32_t q = 0; q < queries.size(); ++q) {
    float lower[3];
    float upper[3];
    for (int a = 0; a < 3; ++a) {
      lower[a] = floatBelow(queries[q].lower[a]);
      upper[a] = floatAbove(queries[q].upper[a]);
    }
    std::int32_t hit[laneCount];
    for (std::size_t g = 0;; ++g) {
      g = nextOverlap(lanes_.data(), g, lanes_.size(), lower, upper, hit);
      if (g == lanes_.size()) break;
      for (std::size_t l = 0; l < laneCount; ++l) {
        const std::size_t leaf = g * laneCount + l;
        if (hit[l] != 0 && queries[q].overlaps(leaf_[leaf])) out.push_back({q, static_cast<std::uint32_t>(leaf)});
      }
    }
  }
}

void SortedGrid::update(std::span<const Box> leaves) {
  leaf_.assign(leaves.begin(), leaves.end());
  if (leaf_.size() <= maxSwept_) {
    BoxLanes empty;
    std::fill_n(&empty.lower[0][0], 3 * laneCount, std::numeric_limits<float>::infinity());
    std::fill_n(&empty.upper[0][0], 3 * laneCount, -std::numeric_limits<float>::infinity());
    lanes_.assign(laneGroups(leaf_.size()), empty);
    for (std::size_t l = 0; l < leaf_.size(); ++l) pack(l);
    return;
  }
  entry_.clear();
  large_.clear();
  for (std::uint32_t l = 0; l < leaf_.size(); ++l) {
    const CellRange range = cellsOf(leaf_[l], cell_);
    if (range.count() > maxCells) {
      large_.push_back(l);
      continue;
    }
    forEachCell(range, [&](std::uint64_t c) { entry_.push_back({c, l}); });
  }
  std::sort(entry_.begin(), entry_.end());
}

void SortedGrid::refit(std::span<const Box> leaves, std::span<const std::uint32_t> changed) {
  if (leaf_.size() <= maxSwept_) {
    for (const std::uint32_t l : changed) {
      leaf_[l] = leaves[l];
      pack(l);
    }
    return;
  }
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
    if (before.count() > maxCells) large_.erase(std::lower_bound(large_.begin(), large_.end(), l));
    if (after.count() > maxCells) {
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
  if (leaf_.size() <= maxSwept_) return sweep(queries, out);
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
