// SPDX-License-Identifier: GPL-3.0-or-later
// Conjugate gradients with a lattice beside the sweeps. With A = L + D + L^T and K = D + L, an iteration is
//   z = K^-T D y + c,  p = z + beta p,  q = A p,  s = K^-1 q,  alpha = r.z / p.q,
//   x += alpha p,  r -= alpha q,  y -= alpha s,
// where y = K^-1 r is updated along with r, and c is the lattice's correction for r. The blocks are read twice: the
// backward sweep applies K^-T and forms half of A p; the forward sweep forms the other half and applies K^-1.
#include <algorithm>
#include <array>
#include <cmath>

#include "sim/solid/coarse_lattice.h"
#include "sim/solid/conjugate_gradient.h"
#include "sim/solid/row_lanes.h"
#include "sim/solid/row_sweeps.h"
#include "sim/solid/sweeps.h"

namespace calot {

SolveReport ConjugateGradient::solve(const BlockMatrix& matrix, std::span<const float> values, CoarseLattice& lattice,
                                     std::span<const float> b, std::span<float> x, const SolveGoal& goal) {
  const sweeps::Slices slices = slicesOf(matrix, values);
  const std::size_t size = matrix.vectorSize();
  clear(size);
  for (std::vector<float>* v : {&q_, &y_, &c_}) v->assign(size, 0.0F);
  for (std::vector<float>* v : {&uw_, &pq_}) v->assign(matrix.rows() * rows::pairStride, 0.0F);
  std::fill(x.begin(), x.end(), 0.0F);
  for (std::size_t row = 0; row < matrix.rows(); ++row) {
    for (std::size_t i = 0; i < 3; ++i) {
      uw_[row * rows::pairStride + rowStride + i] = b[laneOffset(row) + i * laneCount];
    }
  }
  const auto sumOf = [](const std::array<double, laneCount>& lanes) {
    double sum = 0.0;
    for (const double lane : lanes) sum += lane;
    return sum;
  };
  const auto forward = [&] {
    std::array<double, laneCount> dot{};
    sweeps::forwardPairs(slices, p_.data(), uw_.data(), pq_.data(), q_.data(), s_.data(), dot.data());
    return sumOf(dot);
  };
  /// @return r.z of the next residual
  const auto update = [&](float alpha) {
    std::array<double, laneCount> dot{};
    sweeps::updatePairs(slices, alpha, p_.data(), q_.data(), s_.data(), x.data(), r_.data(), y_.data(), z_.data(),
                        dot.data());
    lattice.apply(r_.data(), c_.data());
    return sumOf(dot) + sweeps::dot(r_.data(), c_.data(), size);
  };

  forward();  // of b: there is no p yet
  const double start = update(-1.0F);
  SolveReport report;
  if (!(start > 0.0) || !std::isfinite(start)) {
    report.converged = start == 0.0;
    return report;
  }
  const double from = std::max(start, goal.from());
  const double target = goal.tolerance * goal.tolerance * from;
  double left = start;
  float beta = 0.0F;
  while (left > target && report.iterations < goal.cap) {
    std::fill(uw_.begin(), uw_.end(), 0.0F);
    sweeps::backwardPairs(slices, z_.data(), c_.data(), beta, p_.data(), uw_.data(), pq_.data());
    for (const ExtraBlock& e : extra_) {
      const float* p = pq_.data() + e.column * rows::pairStride;
      for (std::size_t i = 0; i < 3; ++i) {
        uw_[e.row * rows::pairStride + rowStride + i] +=
            (e.value[3 * i] * p[0] + e.value[3 * i + 1] * p[1]) + e.value[3 * i + 2] * p[2];
      }
    }
    const double curvature = forward();
    if (!(curvature > 0.0)) break;  // not positive definite or NaN: keep the current iterate
    const double next = update(static_cast<float>(left / curvature));
    ++report.iterations;
    beta = static_cast<float>(next / left);
    left = next;
  }
  report.residual = std::sqrt(std::max(0.0, left) / from);
  report.converged = left <= target;
  return report;
}

}  // namespace calot
