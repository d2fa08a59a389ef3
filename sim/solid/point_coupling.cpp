// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/solid/solid.h"

#include <algorithm>
#include <utility>

namespace calot {

namespace {

struct RowShare {
  std::size_t row;
  double weight;
};

/// Rows of a point's nodes with their weights; fixed nodes and those of carved cubes alone have none.
void rowsOf(const SolidSystem& system, const MaterialPoint& point, std::vector<RowShare>& out) {
  out.clear();
  for (std::size_t k = 0; k < point.count; ++k) {
    const int row = system.row(static_cast<std::size_t>(point.node[k]));
    if (row >= 0 && point.weight[k] != 0.0) out.push_back({static_cast<std::size_t>(row), point.weight[k]});
  }
}

template <class T>
void makeUnique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

template <class T>
std::uint32_t placeIn(const std::vector<T>& sorted, const T& value) {
  return static_cast<std::uint32_t>(std::lower_bound(sorted.begin(), sorted.end(), value) - sorted.begin());
}

}  // namespace

PointCoupling::PointCoupling(const SolidSystem& first, const SolidSystem& second,
                             std::span<const std::array<MaterialPoint, 2>> points) {
  std::vector<std::pair<std::size_t, std::size_t>> blocks;
  std::vector<RowShare> p;
  std::vector<RowShare> q;
  for (const std::array<MaterialPoint, 2>& damper : points) {
    rowsOf(first, damper[0], p);
    rowsOf(second, damper[1], q);
    for (const RowShare& a : p) {
      for (const RowShare& b : q) blocks.emplace_back(a.row, b.row);
    }
  }
  makeUnique(blocks);
  for (const auto& [row, column] : blocks) {
    side_[0].row.push_back(row);
    side_[1].row.push_back(column);
  }
  for (Side& side : side_) {
    makeUnique(side.row);
    side.direction.resize(side.row.size());
    side.product.resize(side.row.size());
  }
  first_.assign(side_[0].row.size() + 1, 0);
  for (const auto& [row, column] : blocks) {
    ++first_[placeIn(side_[0].row, row) + 1];
    column_.push_back(placeIn(side_[1].row, column));
  }
  for (std::size_t r = 1; r < first_.size(); ++r) first_[r] += first_[r - 1];
  value_.assign(blocks.size(), 0.0F);
  start_.push_back(0);
  for (const std::array<MaterialPoint, 2>& damper : points) {
    rowsOf(first, damper[0], p);
    rowsOf(second, damper[1], q);
    for (const RowShare& a : p) {
      for (const RowShare& b : q) {
        share_.push_back({placeIn(blocks, {a.row, b.row}), static_cast<float>(a.weight * b.weight)});
      }
    }
    start_.push_back(static_cast<std::uint32_t>(share_.size()));
  }
}

void PointCoupling::assemble(std::span<const double> damper, double step) {
  std::fill(value_.begin(), value_.end(), 0.0F);
  for (std::size_t s = 0; s < damper.size(); ++s) {
    const auto whole = static_cast<float>(-step * damper[s]);
    if (whole == 0.0F) continue;
    for (std::uint32_t k = start_[s]; k < start_[s + 1]; ++k) value_[share_[k].block] += whole * share_[k].weight;
  }
}

void PointCoupling::Side::gather(const ConjugateGradient& from) {
  for (std::size_t r = 0; r < row.size(); ++r) {
    direction[r] = from.directionAt(row[r]);
    product[r] = FourFloats{};
  }
}

void PointCoupling::Side::scatter(ConjugateGradient& to) const {
  for (std::size_t r = 0; r < row.size(); ++r) to.addToProduct(row[r], product[r]);
}

void PointCoupling::addTo(ConjugateGradient& first, ConjugateGradient& second) {
  Side& a = side_[0];
  Side& b = side_[1];
  a.gather(first);
  b.gather(second);
  for (std::size_t r = 0; r < a.row.size(); ++r) {
    const FourFloats own = a.direction[r];
    FourFloats sum{};
    for (std::uint32_t k = first_[r]; k < first_[r + 1]; ++k) {
      sum += value_[k] * b.direction[column_[k]];
      b.product[column_[k]] += value_[k] * own;
    }
    a.product[r] = sum;
  }
  a.scatter(first);
  b.scatter(second);
}

}  // namespace calot
