// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/conjugate_gradient.h"

#include <algorithm>
#include <cmath>

#include "sim/solid/sweeps.h"

namespace calot {

namespace {

using Lanes = std::array<float, laneCount>;
using Eight = std::array<double, laneCount>;

double sumOf(const Eight& lanes) {
  double sum = 0.0;
  for (const double lane : lanes) sum += lane;
  return sum;
}

}  // namespace

sweeps::Slices ConjugateGradient::slicesOf(const BlockMatrix& matrix, std::span<const float> values) const {
  return {
      values.data(),  inverse_.data(), matrix.column(0), matrix.firstColumns().data(), matrix.diagonalColumns().data(),
      matrix.slices()};
}

void ConjugateGradient::precompute(const BlockMatrix& matrix, std::span<const float> values,
                                   std::span<const ExtraBlock> extra) {
  extra_.assign(extra.begin(), extra.end());
  inverse_.resize(matrix.slices() * 9 * laneCount);
  sweeps::invertDiagonal(slicesOf(matrix, values), inverse_.data());
}

/// u += E t.
void ConjugateGradient::addExtra() {
  for (const ExtraBlock& e : extra_) {
    const float* t = t_.data() + laneOffset(e.column);
    for (std::size_t i = 0; i < 3; ++i) {
      u_[e.row * rowStride + i] +=
          (e.value[3 * i] * t[0] + e.value[3 * i + 1] * t[laneCount]) + e.value[3 * i + 2] * t[2 * laneCount];
    }
  }
}

void ConjugateGradient::addExtraMany() {
  for (const ExtraBlock& e : extra_) {
    const float* t = t_.data() + e.column * laneStride;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t n = 0; n < laneCount; ++n) {
        u_[e.row * laneStride + i * laneCount + n] +=
            (e.value[3 * i] * t[n] + e.value[3 * i + 1] * t[laneCount + n]) + e.value[3 * i + 2] * t[2 * laneCount + n];
      }
    }
  }
}

/// Values of an earlier solve, perhaps not finite, must not enter through padding.
void ConjugateGradient::clear(std::size_t size) {
  for (std::vector<float>* v : {&r_, &z_, &p_, &t_, &s_}) v->assign(size, 0.0F);
}

SolveReport ConjugateGradient::solve(const BlockMatrix& matrix, std::span<const float> values, std::span<const float> b,
                                     std::span<float> x, const SolveGoal& goal) {
  const sweeps::Slices slices = slicesOf(matrix, values);
  clear(matrix.vectorSize());
  sRows_.assign(matrix.rows() * rowStride, 0.0F);
  u_.resize(matrix.rows() * rowStride);
  for (std::size_t row = 0; row < matrix.rows(); ++row) {
    for (std::size_t i = 0; i < rowStride; ++i) {
      u_[row * rowStride + i] = i < 3 ? b[laneOffset(row) + i * laneCount] : 0.0F;
    }
  }
  std::fill(x.begin(), x.end(), 0.0F);
  const auto forward = [&](std::vector<float>& s) {
    Eight dot{};
    sweeps::forward(slices, u_.data(), s.data(), sRows_.data(), p_.data(), t_.data(), dot.data());
    return sumOf(dot);
  };
  const auto update = [&](float alpha) {
    Eight dot{};
    sweeps::update(slices, alpha, t_.data(), s_.data(), x.data(), r_.data(), z_.data(), dot.data());
    return sumOf(dot);
  };

  forward(r_);
  const double start = update(0.0F);
  SolveReport report;
  if (!(start > 0.0) || !std::isfinite(start)) {
    report.converged = start == 0.0;
    return report;
  }
  const double from = std::max(start, goal.from());
  const double target = goal.tolerance * goal.tolerance * from;
  double size = start;
  float beta = 0.0F;
  while (size > target && report.iterations < goal.cap) {
    std::fill(u_.begin(), u_.end(), 0.0F);
    sweeps::backward(slices, z_.data(), beta, p_.data(), t_.data(), u_.data());
    addExtra();
    const double curvature = forward(s_);
    if (!(curvature > 0.0)) break;  // not positive definite or NaN: keep the current iterate
    const double next = update(static_cast<float>(size / curvature));
    beta = static_cast<float>(next / size);
    size = next;
    ++report.iterations;
  }
  report.residual = std::sqrt(size / from);
  report.converged = size <= target;
  return report;
}

SolveReport ConjugateGradient::solveMany(const BlockMatrix& matrix, std::span<const float> values,
                                         std::span<const float> b, std::span<float> x, double tolerance,
                                         std::uint32_t cap) {
  const sweeps::Slices slices = slicesOf(matrix, values);
  clear(matrix.vectorSize() * laneCount);
  u_.assign(b.begin(), b.end());
  std::fill(x.begin(), x.end(), 0.0F);
  const auto forward = [&](std::vector<float>& s) {
    Eight dot{};
    sweeps::forwardMany(slices, u_.data(), s.data(), p_.data(), t_.data(), dot.data());
    return dot;
  };
  const auto update = [&](const Lanes& alpha) {
    Eight dot{};
    sweeps::updateMany(slices, alpha.data(), t_.data(), s_.data(), x.data(), r_.data(), z_.data(), dot.data());
    return dot;
  };

  forward(r_);
  const Eight start = update({});
  Eight size = start;
  Eight target{};
  for (std::size_t n = 0; n < laneCount; ++n) target[n] = tolerance * tolerance * start[n];
  const auto open = [&](std::size_t n) { return start[n] > 0.0 && std::isfinite(start[n]) && size[n] > target[n]; };
  const auto anyOpen = [&] {
    for (std::size_t n = 0; n < laneCount; ++n) {
      if (open(n)) return true;
    }
    return false;
  };
  SolveReport report;
  Lanes beta{};
  while (anyOpen() && report.iterations < cap) {
    std::fill(u_.begin(), u_.end(), 0.0F);
    sweeps::backwardMany(slices, z_.data(), beta.data(), p_.data(), t_.data(), u_.data());
    addExtraMany();
    const Eight curvature = forward(s_);
    Lanes alpha{};
    bool moved = false;
    for (std::size_t n = 0; n < laneCount; ++n) {
      if (!open(n) || !(curvature[n] > 0.0)) continue;
      alpha[n] = static_cast<float>(size[n] / curvature[n]);
      moved = true;
    }
    if (!moved) break;
    const Eight next = update(alpha);
    for (std::size_t n = 0; n < laneCount; ++n) {
      beta[n] = open(n) ? static_cast<float>(next[n] / size[n]) : 0.0F;
      size[n] = next[n];
    }
    ++report.iterations;
  }
  for (std::size_t n = 0; n < laneCount; ++n) {
    if (start[n] == 0.0) continue;
    report.residual = std::max(report.residual, std::sqrt(size[n] / start[n]));
    report.converged = report.converged && size[n] <= target[n];
  }
  return report;
}

}  // namespace calot
