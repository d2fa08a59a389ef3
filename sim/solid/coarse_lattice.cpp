// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/coarse_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "sim/math/symmetric_blocks.h"
#include "sim/solid/block_matrix.h"
#include "sim/solid/conjugate_gradient.h"
#include "sim/solid/sweeps.h"

namespace calot {

namespace {

constexpr std::size_t minNodes = 2000;     ///< free nodes
constexpr std::size_t nodesPerCell = 100;  ///< of the solid
constexpr double maxCells = 128.0;         ///< so that E^-1 stays smaller than the matrix
constexpr double minWeight = 1.0;          ///< of a lattice node, in nodes of the solid: less makes E nearly singular

/// Cell along one axis and the position within it.
struct Along {
  std::size_t cell;
  double rest;
};
Along along(double at, std::size_t cells) {
  const double scaled = at * static_cast<double>(cells);
  const auto cell = std::min(cells - 1, static_cast<std::size_t>(std::max(0.0, scaled)));
  return {cell, scaled - static_cast<double>(cell)};
}

}  // namespace

bool CoarseLattice::isWorthwhile(const SolidModel& model) {
  return !model.madeOfCubes() && model.freeNodes().size() >= minNodes;
}

CoarseLattice::CoarseLattice(const SolidModel& model, std::span<const float> rest) : model_(model) {
  placeNodes();
  if (!invert(rest)) inverse_.clear();
}

void CoarseLattice::placeNodes() {
  const SolidSystem& system = model_.system();
  const std::size_t rows = system.matrix().rows();
  Vec3 low = model_.rest().front();
  Vec3 high = low;
  for (const Vec3& p : model_.rest()) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Vec3 size = (high - low).cwiseMax(1e-9);
  const double wanted = std::min(maxCells, static_cast<double>(model_.freeNodes().size()) / nodesPerCell);
  std::array<std::size_t, 3> cells{};
  double edge = size.maxCoeff();
  for (double count = 0.0; count < wanted; edge *= 0.95) {
    count = 1.0;
    for (std::size_t a = 0; a < 3; ++a) {
      cells[a] = static_cast<std::size_t>(std::max(1.0, std::floor(size[static_cast<int>(a)] / edge + 0.5)));
      count *= static_cast<double>(cells[a]);
    }
  }
  const auto number = [&](std::size_t i, std::size_t j, std::size_t k) {
    return (i * (cells[1] + 1) + j) * (cells[2] + 1) + k;
  };
  std::vector<std::array<std::uint32_t, corners>> nodeOf(rows);
  share_.assign(rows, {});
  std::vector<double> weight(number(cells[0], cells[1], cells[2]) + 1, 0.0);
  element_.assign(rows, {-1, -1, -1, -1});
  for (const int free : model_.freeNodes()) {
    const auto node = static_cast<std::size_t>(free);
    const auto row = static_cast<std::size_t>(system.row(node));
    const Vec3 at = (model_.rest()[node] - low).cwiseQuotient(size);
    const Along x = along(at[0], cells[0]);
    const Along y = along(at[1], cells[1]);
    const Along z = along(at[2], cells[2]);
    for (std::size_t c = 0; c < corners; ++c) {
      const std::size_t i = c & 1U;
      const std::size_t j = c >> 1U & 1U;
      const std::size_t k = c >> 2U;
      const double w =
          (i == 0 ? 1.0 - x.rest : x.rest) * (j == 0 ? 1.0 - y.rest : y.rest) * (k == 0 ? 1.0 - z.rest : z.rest);
      const std::size_t q = number(x.cell + i, y.cell + j, z.cell + k);
      nodeOf[row][c] = static_cast<std::uint32_t>(q);
      share_[row].weight[c] = static_cast<float>(w);
      weight[q] += w;
    }
    const auto incident = system.incident(node);
    for (std::size_t s = 0; s < sampled; ++s) element_[row][s] = incident[s * incident.size() / sampled].element;
  }
  // Only lattice nodes with sufficient weight get a number.
  std::vector<std::uint32_t> compact(weight.size(), 0);
  std::uint32_t count = 0;
  for (std::size_t q = 0; q < weight.size(); ++q) {
    if (weight[q] >= minWeight) compact[q] = count++;
  }
  std::vector<std::vector<sweeps::Part>> parts(count);
  std::map<std::array<std::uint32_t, 2>, std::uint32_t> edges;
  for (std::size_t row = 0; row < rows; ++row) {
    sweeps::Share& share = share_[row];
    for (std::size_t c = 0; c < corners; ++c) {
      const std::size_t q = nodeOf[row][c];
      if (weight[q] < minWeight) share.weight[c] = 0.0F;
      nodeOf[row][c] = compact[q];
      if (share.weight[c] == 0.0F) continue;
      parts[compact[q]].push_back({static_cast<std::uint32_t>(row * rowStride), share.weight[c]});
    }
    for (std::size_t e = 0; e < corners / 2; ++e) {
      const std::array<std::uint32_t, 2> ends{nodeOf[row][2 * e], nodeOf[row][2 * e + 1]};
      const auto [at, isNew] = edges.emplace(ends, static_cast<std::uint32_t>(edge_.size()));
      if (isNew) edge_.push_back(ends);
      share.edge[e] = at->second;
    }
  }
  start_.assign(1, 0);
  for (const std::vector<sweeps::Part>& of : parts) {
    part_.insert(part_.end(), of.begin(), of.end());
    start_.push_back(part_.size());
  }
}

bool CoarseLattice::invert(std::span<const float> rest) {
  const BlockMatrix& matrix = model_.system().matrix();
  const std::size_t count = start_.size() - 1;
  const std::size_t size = 3 * count;
  if (count == 0) return false;
  std::vector<double> e(size * size, 0.0);
  const auto add = [&](std::size_t row, std::size_t column, const float* block, bool mirrored) {
    for (std::size_t a = 0; a < corners; ++a) {
      for (std::size_t b = 0; b < corners; ++b) {
        const double w = static_cast<double>(share_[row].weight[a]) * static_cast<double>(share_[column].weight[b]);
        if (w == 0.0) continue;
        const std::size_t p = 3 * static_cast<std::size_t>(edge_[share_[row].edge[a / 2]][a % 2]);
        const std::size_t q = 3 * static_cast<std::size_t>(edge_[share_[column].edge[b / 2]][b % 2]);
        for (std::size_t i = 0; i < 3; ++i) {
          for (std::size_t j = 0; j < 3; ++j) {
            const double value = w * static_cast<double>(block[(3 * i + j) * laneCount]);
            e[(p + i) * size + q + j] += value;
            if (mirrored) e[(q + j) * size + p + i] += value;
          }
        }
      }
    }
  };
  for (const int free : model_.freeNodes()) {
    const auto row = static_cast<std::size_t>(model_.row(static_cast<std::size_t>(free)));
    const std::size_t slice = row / laneCount;
    const std::size_t lane = row % laneCount;
    const BlockMatrix::Part lower = matrix.lower(slice);
    const std::size_t blocks = model_.system().ofRow(row).size() - 1;
    for (std::size_t k = 0; k < blocks; ++k) {
      const auto column = static_cast<std::size_t>(matrix.column(lower.first + k)[lane]) / rowStride;
      add(row, column, rest.data() + lower.value() + k * 9 * laneCount + lane, true);
    }
    add(row, row, rest.data() + matrix.diagonal(slice) + lane, false);
  }
  if (!invertPositive(e, size)) return false;
  stride_ = laneGroups(size) * laneCount;
  inverse_.assign(size * stride_, 0.0F);
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) inverse_[i * stride_ + j] = static_cast<float>(e[i * size + j]);
  }
  rotated_.assign(matrix.rows() * rowStride, 0.0F);
  coarse_.assign(stride_, 0.0F);
  solution_.assign(rowStride * count, 0.0F);
  ends_.assign(2 * rowStride * edge_.size(), 0.0F);
  return true;
}

void CoarseLattice::rotate(std::span<const RotationGroup> rotation) {
  if (inverse_.empty()) return;
  const std::size_t rows = element_.size();
  quaternion_.assign(rows * 4, 0.0F);
  for (std::size_t row = 0; row < rows; ++row) {
    std::array<float, 4> sum{};
    std::array<float, 4> first{};
    for (std::size_t s = 0; s < sampled && element_[row][s] >= 0; ++s) {
      const auto e = static_cast<std::size_t>(element_[row][s]);
      std::array<float, 4> q{};
      for (std::size_t i = 0; i < 4; ++i) q[i] = static_cast<float>(rotation[e / laneCount][i][e % laneCount]);
      if (s == 0) first = q;
      const bool other = ((q[0] * first[0] + q[1] * first[1]) + q[2] * first[2]) + q[3] * first[3] < 0.0F;
      for (std::size_t i = 0; i < 4; ++i) sum[i] += other ? -q[i] : q[i];
    }
    const float square = ((sum[0] * sum[0] + sum[1] * sum[1]) + sum[2] * sum[2]) + sum[3] * sum[3];
    if (!(square > 1e-6F)) sum = {1.0F, 0.0F, 0.0F, 0.0F};
    const float by = square > 1e-6F ? 1.0F / std::sqrt(square) : 1.0F;
    for (std::size_t i = 0; i < 4; ++i) {
      quaternion_[row / laneCount * 4 * laneCount + i * laneCount + row % laneCount] = by * sum[i];
    }
  }
}

void CoarseLattice::apply(const float* r, float* c) {
  if (inverse_.empty()) return;
  const std::size_t slices = element_.size() / laneCount;
  const std::size_t nodes = start_.size() - 1;
  sweeps::unrotateRows(quaternion_.data(), r, rotated_.data(), slices);
  for (std::size_t q = 0; q < nodes; ++q) {
    sweeps::gather(part_.data() + start_[q], start_[q + 1] - start_[q], rotated_.data(), coarse_.data() + 3 * q);
  }
  sweeps::denseTimes(inverse_.data(), coarse_.data(), 3 * nodes, stride_, solution_.data());
  for (std::size_t e = 0; e < edge_.size(); ++e) {
    for (std::size_t k = 0; k < 2; ++k) {
      std::copy_n(solution_.data() + rowStride * edge_[e][k], rowStride, ends_.data() + (2 * e + k) * rowStride);
    }
  }
  sweeps::spread(share_.data(), share_.size(), ends_.data(), rotated_.data());
  sweeps::rotateRows(quaternion_.data(), rotated_.data(), c, slices);
}

// Conjugate gradients with a lattice beside the sweeps. With A = L + D + L^T and K = D + L, an iteration is
//   z = K^-T D y + c,  p = z + beta p,  q = A p,  s = K^-1 q,  alpha = r.z / p.q,
//   x += alpha p,  r -= alpha q,  y -= alpha s,
// where y = K^-1 r is updated along with r, and c is the lattice's correction for r. The blocks are read twice: the
// backward sweep applies K^-T and forms half of A p; the forward sweep forms the other half and applies K^-1.

/// q = b, s = K^-1 b.
void ConjugateGradient::beginPairs(const Part& part, bool goesOn) {
  const std::size_t size = part.matrix.vectorSize();
  for (std::vector<float>* v : {&q_, &c_}) v->assign(size, 0.0F);
  if (goesOn) {
    startFrom(left_);  // y goes with it
  } else {
    y_.assign(size, 0.0F);
  }
  for (std::vector<float>* v : {&uw_, &pq_}) v->assign(part.matrix.rows() * rows::pairStride, 0.0F);
  for (std::size_t row = 0; row < part.matrix.rows(); ++row) {
    for (std::size_t i = 0; i < 3; ++i) {
      uw_[row * rows::pairStride + rowStride + i] = part.b[laneOffset(row) + i * laneCount];
    }
  }
  static_cast<void>(forwardPairs(part));  // there is no p yet
}

void ConjugateGradient::backwardPairs(const Part& part, float beta) {
  std::fill(uw_.begin(), uw_.end(), 0.0F);
  sweeps::backwardPairs(slicesOf(part.matrix, part.values), z_.data(), c_.data(), beta, p_.data(), uw_.data(),
                        pq_.data());
  for (const ExtraBlock& e : extra_) {
    const float* p = pq_.data() + e.column * rows::pairStride;
    for (std::size_t i = 0; i < 3; ++i) {
      uw_[e.row * rows::pairStride + rowStride + i] +=
          (e.value[3 * i] * p[0] + e.value[3 * i + 1] * p[1]) + e.value[3 * i + 2] * p[2];
    }
  }
}

double ConjugateGradient::forwardPairs(const Part& part) {
  std::array<double, laneCount> dot{};
  sweeps::forwardPairs(slicesOf(part.matrix, part.values), p_.data(), uw_.data(), pq_.data(), q_.data(), s_.data(),
                       dot.data());
  return sumOf(dot);
}

double ConjugateGradient::updatePairs(const Part& part, float alpha) {
  std::array<double, laneCount> dot{};
  sweeps::updatePairs(slicesOf(part.matrix, part.values), alpha, p_.data(), q_.data(), s_.data(), part.x.data(),
                      r_.data(), y_.data(), z_.data(), dot.data());
  part.lattice->apply(r_.data(), c_.data());
  return sumOf(dot) + sweeps::dot(r_.data(), c_.data(), part.matrix.vectorSize());
}

}  // namespace calot
