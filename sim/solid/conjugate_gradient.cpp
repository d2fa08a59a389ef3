// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/conjugate_gradient.h"

#include <algorithm>
#include <cmath>

#include "sim/solid/block_matrix.h"
#include "sim/solid/sweeps.h"

namespace calot {

namespace {

using Lanes = std::array<float, laneCount>;
using Eight = std::array<double, laneCount>;

}  // namespace

double ConjugateGradient::sumOf(const Eight& lanes) {
  double sum = 0.0;
  for (const double lane : lanes) sum += lane;
  return sum;
}

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

void ConjugateGradient::begin(const Part& part, bool goesOn) {
  const BlockMatrix& matrix = part.matrix;
  pairs_ = part.lattice != nullptr;
  if (goesOn) std::swap(left_, r_);
  clear(matrix.vectorSize());
  std::fill(part.x.begin(), part.x.end(), 0.0F);
  if (pairs_) return beginPairs(part, goesOn);
  sRows_.assign(matrix.rows() * rowStride, 0.0F);
  u_.resize(matrix.rows() * rowStride);
  for (std::size_t row = 0; row < matrix.rows(); ++row) {
    for (std::size_t i = 0; i < rowStride; ++i) {
      u_[row * rowStride + i] = i < 3 ? part.b[laneOffset(row) + i * laneCount] : 0.0F;
    }
  }
  Eight dot{};
  sweeps::forward(slicesOf(matrix, part.values), u_.data(), r_.data(), sRows_.data(), p_.data(), t_.data(), dot.data());
  if (goesOn) startFrom(left_);
}

/// r += what was left.
void ConjugateGradient::startFrom(const std::vector<float>& left) {
  for (std::size_t i = 0; i < r_.size(); ++i) r_[i] += left[i];
}

void ConjugateGradient::backward(const Part& part, float beta) {
  if (pairs_) return backwardPairs(part, beta);
  std::fill(u_.begin(), u_.end(), 0.0F);
  sweeps::backward(slicesOf(part.matrix, part.values), z_.data(), beta, p_.data(), t_.data(), u_.data());
  // u += E t
  for (const ExtraBlock& e : extra_) {
    const float* t = t_.data() + laneOffset(e.column);
    for (std::size_t i = 0; i < 3; ++i) {
      u_[e.row * rowStride + i] +=
          (e.value[3 * i] * t[0] + e.value[3 * i + 1] * t[laneCount]) + e.value[3 * i + 2] * t[2 * laneCount];
    }
  }
}

double ConjugateGradient::forward(const Part& part) {
  if (pairs_) return forwardPairs(part);
  Eight dot{};
  sweeps::forward(slicesOf(part.matrix, part.values), u_.data(), s_.data(), sRows_.data(), p_.data(), t_.data(),
                  dot.data());
  return sumOf(dot);
}

double ConjugateGradient::update(const Part& part, float alpha) {
  if (pairs_) return updatePairs(part, alpha);
  Eight dot{};
  sweeps::update(slicesOf(part.matrix, part.values), alpha, t_.data(), s_.data(), part.x.data(), r_.data(), z_.data(),
                 dot.data());
  return sumOf(dot);
}

SolveReport ConjugateGradient::solveJoined(std::span<const Part> parts, std::span<const Coupled> couplings,
                                           const SolveGoal& goal) {
  const auto sumOver = [&](auto&& of) {
    double sum = 0.0;
    for (const Part& part : parts) sum += of(part);
    return sum;
  };
  for (const Part& part : parts) part.gradient.begin(part, goal.goesOn);
  // With a lattice r is the residual itself, which the update subtracts from zero.
  const double start =
      sumOver([](const Part& part) { return part.gradient.update(part, part.gradient.pairs_ ? -1.0F : 0.0F); });
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
    for (const Part& part : parts) part.gradient.backward(part, beta);
    for (const Coupled& c : couplings) c.by.addTo(parts[c.first].gradient, parts[c.second].gradient);
    const double curvature = sumOver([](const Part& part) { return part.gradient.forward(part); });
    if (!(curvature > 0.0)) break;  // not positive definite or NaN: keep the current iterate
    const auto alpha = static_cast<float>(size / curvature);
    const double next = sumOver([alpha](const Part& part) { return part.gradient.update(part, alpha); });
    beta = static_cast<float>(next / size);
    size = next;
    ++report.iterations;
  }
  report.residual = std::sqrt(std::max(0.0, size) / from);
  report.converged = size <= target;
  return report;
}

SolveReport ConjugateGradient::solve(const BlockMatrix& matrix, std::span<const float> values, std::span<const float> b,
                                     std::span<float> x, const SolveGoal& goal) {
  const Part part{*this, matrix, values, nullptr, b, x};
  return solveJoined({&part, 1}, {}, goal);
}

SolveReport ConjugateGradient::solve(const BlockMatrix& matrix, std::span<const float> values, CoarseLattice& lattice,
                                     std::span<const float> b, std::span<float> x, const SolveGoal& goal) {
  const Part part{*this, matrix, values, &lattice, b, x};
  return solveJoined({&part, 1}, {}, goal);
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
