// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/math/symmetric_blocks.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <set>

namespace calot {

namespace {

/// Corrections of a solution at most. Two reach the accuracy of its residual.
constexpr int maxRefinements = 3;

/// L^-1 of a 3 x 3 block A = L L^T. A pivot below its share of `whole` becomes none: its row and column of L^-1 are
/// zero. @return how many
std::size_t invertFactor(const Mat3& a, const Vec3& whole, Mat3& inverse) {
  Mat3 l = Mat3::Zero();
  std::size_t fixed = 0;
  Vec3 reciprocal = Vec3::Zero();
  for (int j = 0; j < 3; ++j) {
    double pivot = a(j, j);
    for (int k = 0; k < j; ++k) pivot -= l(j, k) * l(j, k);
    if (!(pivot > SymmetricBlocks::singular * whole[j]) || !std::isfinite(pivot)) {
      ++fixed;
      continue;
    }
    l(j, j) = std::sqrt(pivot);
    reciprocal[j] = 1.0 / l(j, j);
    for (int i = j + 1; i < 3; ++i) {
      double sum = a(i, j);
      for (int k = 0; k < j; ++k) sum -= l(i, k) * l(j, k);
      l(i, j) = sum * reciprocal[j];
    }
  }
  inverse.setZero();
  for (int j = 0; j < 3; ++j) {
    inverse(j, j) = reciprocal[j];
    for (int i = j + 1; i < 3; ++i) {
      double sum = 0.0;
      for (int k = j; k < i; ++k) sum -= l(i, k) * inverse(k, j);
      inverse(i, j) = sum * reciprocal[i];
    }
  }
  return fixed;
}

double squareOf(std::span<const Vec3> x) {
  double sum = 0.0;
  for (const Vec3& v : x) sum += v.squaredNorm();
  return sum;
}

}  // namespace

void SymmetricBlocks::add(std::size_t i, std::size_t j, const Mat3& block) {
  assert(i < row_.size() && j < row_.size());
  Mat3& own = row_[std::max(i, j)].try_emplace(std::min(i, j), Mat3::Zero()).first->second;
  if (i >= j) {
    own += block;
  } else {
    own += block.transpose();
  }
}

/// Eliminates the row that meets the fewest others; those then meet one another.
void SymmetricBlocks::order() {
  const std::size_t n = row_.size();
  std::vector<std::vector<std::size_t>> meets(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (const auto& [j, block] : row_[i]) {
      if (j == i) continue;
      meets[i].push_back(j);
      meets[j].push_back(i);
    }
  }
  std::set<std::pair<std::size_t, std::size_t>> queue;
  for (std::size_t i = 0; i < n; ++i) {
    std::sort(meets[i].begin(), meets[i].end());
    queue.emplace(meets[i].size(), i);
  }
  eliminated_.clear();
  below_.assign(n, {});
  std::vector<std::size_t> merged;
  while (!queue.empty()) {
    const std::size_t k = queue.begin()->second;
    queue.erase(queue.begin());
    for (const std::size_t i : meets[k]) {
      queue.erase({meets[i].size(), i});
      merged.clear();
      std::set_union(meets[i].begin(), meets[i].end(), meets[k].begin(), meets[k].end(), std::back_inserter(merged));
      std::erase_if(merged, [&](std::size_t other) { return other == i || other == k; });
      meets[i].assign(merged.begin(), merged.end());
      queue.emplace(meets[i].size(), i);
    }
    below_[eliminated_.size()] = std::move(meets[k]);
    eliminated_.push_back(k);
  }
  std::vector<std::size_t> place(n);
  for (std::size_t k = 0; k < n; ++k) place[eliminated_[k]] = k;
  for (std::vector<std::size_t>& rows : below_) {
    for (std::size_t& i : rows) i = place[i];
    std::sort(rows.begin(), rows.end());
  }
}

std::size_t SymmetricBlocks::factor() {
  order();
  const std::size_t n = row_.size();
  lower_.assign(n, {});
  diagonal_.assign(n, Mat3::Zero());
  std::vector<std::size_t> place(n);
  for (std::size_t k = 0; k < n; ++k) place[eliminated_[k]] = k;
  const auto slot = [&](std::size_t column, std::size_t row) {
    const std::vector<std::size_t>& rows = below_[column];
    return static_cast<std::size_t>(std::lower_bound(rows.begin(), rows.end(), row) - rows.begin());
  };
  std::vector<Vec3> whole(n, Vec3::Zero());
  for (std::size_t k = 0; k < n; ++k) lower_[k].assign(below_[k].size(), Mat3::Zero());
  for (std::size_t i = 0; i < n; ++i) {
    for (const auto& [j, block] : row_[i]) {
      const std::size_t a = place[i];
      const std::size_t b = place[j];
      if (a == b) {
        diagonal_[a] = block;
        whole[a] = block.diagonal();
      } else if (a > b) {
        lower_[b][slot(b, a)] = block;
      } else {
        lower_[a][slot(a, b)] = block.transpose();
      }
    }
  }
  std::size_t fixed = 0;
  for (std::size_t k = 0; k < n; ++k) {
    Mat3 inverse;
    fixed += invertFactor(diagonal_[k], whole[k], inverse);
    diagonal_[k] = inverse;
    std::vector<Mat3>& column = lower_[k];
    for (Mat3& block : column) block = block * inverse.transpose();
    for (std::size_t b = 0; b < column.size(); ++b) {
      const std::size_t j = below_[k][b];
      const Mat3 transposed = column[b].transpose();
      diagonal_[j] -= column[b] * transposed;
      std::size_t at = 0;
      for (std::size_t a = b + 1; a < column.size(); ++a) {
        while (below_[j][at] != below_[k][a]) ++at;
        lower_[j][at] -= column[a] * transposed;
      }
    }
  }
  return fixed;
}

/// L L^T x = b, in place.
void SymmetricBlocks::substitute(std::vector<Vec3>& x) const {
  const std::size_t n = row_.size();
  std::vector<Vec3> y(n);
  for (std::size_t k = 0; k < n; ++k) y[k] = x[eliminated_[k]];
  for (std::size_t k = 0; k < n; ++k) {
    y[k] = diagonal_[k] * y[k];
    for (std::size_t a = 0; a < below_[k].size(); ++a) y[below_[k][a]] -= lower_[k][a] * y[k];
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t a = 0; a < below_[k].size(); ++a) y[k] -= lower_[k][a].transpose() * y[below_[k][a]];
    y[k] = diagonal_[k].transpose() * y[k];
  }
  for (std::size_t k = 0; k < n; ++k) x[eliminated_[k]] = y[k];
}

std::vector<Vec3> SymmetricBlocks::times(std::span<const Vec3> x) const {
  std::vector<Vec3> out(row_.size(), Vec3::Zero());
  for (std::size_t i = 0; i < row_.size(); ++i) {
    for (const auto& [j, block] : row_[i]) {
      out[i] += block * x[j];
      if (j != i) out[j] += block.transpose() * x[i];
    }
  }
  return out;
}

std::vector<Vec3> SymmetricBlocks::solve(std::span<const Vec3> b) const {
  assert(b.size() == row_.size());
  std::vector<Vec3> best(row_.size(), Vec3::Zero());
  std::vector<Vec3> residual(b.begin(), b.end());
  double error = squareOf(residual);
  for (int pass = 0; pass <= maxRefinements; ++pass) {
    std::vector<Vec3> x = residual;
    substitute(x);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += best[i];
    std::vector<Vec3> left = times(x);
    for (std::size_t i = 0; i < left.size(); ++i) left[i] = b[i] - left[i];
    const double now = squareOf(left);
    if (!(now < error)) break;
    best = std::move(x);
    residual = std::move(left);
    error = now;
  }
  return best;
}

bool invertPositive(std::span<double> a, std::size_t n) {
  assert(a.size() == n * n);
  for (std::size_t j = 0; j < n; ++j) {
    double pivot = a[j * n + j];
    for (std::size_t k = 0; k < j; ++k) pivot -= a[j * n + k] * a[j * n + k];
    if (!(pivot > 0.0) || !std::isfinite(pivot)) return false;
    const double inverse = 1.0 / std::sqrt(pivot);
    a[j * n + j] = inverse;
    for (std::size_t i = j + 1; i < n; ++i) {
      double sum = a[i * n + j];
      for (std::size_t k = 0; k < j; ++k) sum -= a[i * n + k] * a[j * n + k];
      a[i * n + j] = sum * inverse;
    }
  }
  // L^-1 in the lower triangle.
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = j + 1; i < n; ++i) {
      double sum = 0.0;
      for (std::size_t k = j; k < i; ++k) sum -= a[i * n + k] * a[k * n + j];
      a[i * n + j] = sum * a[i * n + i];
    }
  }
  // L^-T L^-1: entry (i, j) reads rows at or below the larger index, so that processing rows from the
  // top overwrites nothing needed.
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = 0.0;
      for (std::size_t k = i; k < n; ++k) sum += a[k * n + i] * a[k * n + j];
      a[i * n + j] = sum;
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < i; ++j) a[j * n + i] = a[i * n + j];
  }
  return true;
}

}  // namespace calot
