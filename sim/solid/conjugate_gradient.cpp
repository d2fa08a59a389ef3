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

/// Inverse of a 3x3 block, each of whose entries stands eight numbers after the one before; zero where it is none,
/// which is a row that only fills a slice up.
void invertBlock(const float* in, float* out) {
  const auto a = [in](std::size_t i, std::size_t j) { return static_cast<double>(in[(3 * i + j) * laneCount]); };
  const double c00 = a(1, 1) * a(2, 2) - a(1, 2) * a(2, 1);
  const double c01 = a(0, 2) * a(2, 1) - a(0, 1) * a(2, 2);
  const double c02 = a(0, 1) * a(1, 2) - a(0, 2) * a(1, 1);
  const double c10 = a(1, 2) * a(2, 0) - a(1, 0) * a(2, 2);
  const double c11 = a(0, 0) * a(2, 2) - a(0, 2) * a(2, 0);
  const double c12 = a(0, 2) * a(1, 0) - a(0, 0) * a(1, 2);
  const double c20 = a(1, 0) * a(2, 1) - a(1, 1) * a(2, 0);
  const double c21 = a(0, 1) * a(2, 0) - a(0, 0) * a(2, 1);
  const double c22 = a(0, 0) * a(1, 1) - a(0, 1) * a(1, 0);
  const double determinant = (a(0, 0) * c00 + a(0, 1) * c10) + a(0, 2) * c20;
  const double inverse = determinant == 0.0 ? 0.0 : 1.0 / determinant;
  const double c[9] = {c00, c01, c02, c10, c11, c12, c20, c21, c22};
  for (std::size_t i = 0; i < 9; ++i) out[i * laneCount] = static_cast<float>(c[i] * inverse);
}

/// Blocks of a slice, or (lane above 0) of one of its rows on.
sweeps::Blocks blocksOf(const BlockMatrix& matrix, std::span<const float> values, std::size_t slice,
                        std::size_t lane = 0) {
  const BlockMatrix::Part part = matrix.lower(slice);
  return {values.data() + part.value() + lane, matrix.column(part.first) + lane, part.width};
}

}  // namespace

void ConjugateGradient::prepare(const BlockMatrix& matrix, std::span<const float> values,
                                std::span<const ExtraBlock> extra) {
  extra_.assign(extra.begin(), extra.end());
  inverse_.resize(matrix.slices() * 9 * laneCount);
  for (std::size_t slice = 0; slice < matrix.slices(); ++slice) {
    for (std::size_t lane = 0; lane < laneCount; ++lane) {
      invertBlock(values.data() + matrix.diagonal(slice) + lane, inverse_.data() + slice * 9 * laneCount + lane);
    }
  }
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

/// Nothing that an earlier solve left, not finite perhaps, may reach this one through a padded block.
void ConjugateGradient::clear(std::size_t size) {
  for (std::vector<float>* v : {&r_, &z_, &p_, &t_, &s_}) v->assign(size, 0.0F);
}

SolveReport ConjugateGradient::solve(const BlockMatrix& matrix, std::span<const float> values, std::span<const float> b,
                                     std::span<float> x, double tolerance, std::uint32_t cap) {
  const std::size_t slices = matrix.slices();
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
    for (std::size_t i = 0; i < slices; ++i) {
      sweeps::forward(blocksOf(matrix, values, i), inverse_.data() + i * 9 * laneCount, u_.data(), s.data(),
                      sRows_.data(), p_.data(), t_.data(), dot.data(), i * laneStride);
    }
    return sumOf(dot);
  };
  const auto update = [&](float by) {
    Lanes alpha;
    alpha.fill(by);
    Eight dot{};
    for (std::size_t i = 0; i < slices; ++i) {
      sweeps::update(values.data() + matrix.diagonal(i), alpha.data(), t_.data(), s_.data(), x.data(), r_.data(),
                     z_.data(), dot.data(), i * laneStride);
    }
    return sumOf(dot);
  };

  forward(r_);
  const double start = update(0.0F);
  SolveReport report;
  if (!(start > 0.0) || !std::isfinite(start)) {
    report.converged = start == 0.0;
    return report;
  }
  const double goal = tolerance * tolerance * start;
  double size = start;
  Lanes beta{};
  while (size > goal && report.iterations < cap) {
    std::fill(u_.begin(), u_.end(), 0.0F);
    for (std::size_t i = slices; i-- > 0;) {
      sweeps::backward(blocksOf(matrix, values, i), inverse_.data() + i * 9 * laneCount, z_.data(), beta.data(),
                       p_.data(), t_.data(), u_.data(), i * laneStride);
    }
    addExtra();
    const double curvature = forward(s_);
    if (!(curvature > 0.0)) break;  // not positive definite, or not a number: what is reached so far stands
    const double next = update(static_cast<float>(size / curvature));
    beta.fill(static_cast<float>(next / size));
    size = next;
    ++report.iterations;
  }
  report.residual = std::sqrt(size / start);
  report.converged = size <= goal;
  return report;
}

SolveReport ConjugateGradient::solveMany(const BlockMatrix& matrix, std::span<const float> values,
                                         std::span<const float> b, std::span<float> x, double tolerance,
                                         std::uint32_t cap) {
  const std::size_t rows = matrix.rows();
  clear(matrix.vectorSize() * laneCount);
  u_.assign(b.begin(), b.end());
  std::fill(x.begin(), x.end(), 0.0F);
  const auto inverseOf = [&](std::size_t r) { return inverse_.data() + r / laneCount * 9 * laneCount + r % laneCount; };
  const auto blocks = [&](std::size_t r) { return blocksOf(matrix, values, r / laneCount, r % laneCount); };
  const auto forward = [&](std::vector<float>& s) {
    Eight dot{};
    for (std::size_t r = 0; r < rows; ++r) {
      sweeps::forwardMany(blocks(r), inverseOf(r), u_.data(), s.data(), p_.data(), t_.data(), dot.data(),
                          r * laneStride);
    }
    return dot;
  };
  const auto update = [&](const Lanes& alpha) {
    Eight dot{};
    for (std::size_t r = 0; r < rows; ++r) {
      sweeps::updateMany(values.data() + matrix.diagonal(r / laneCount) + r % laneCount, alpha.data(), t_.data(),
                         s_.data(), x.data(), r_.data(), z_.data(), dot.data(), r * laneStride);
    }
    return dot;
  };

  forward(r_);
  const Eight start = update({});
  Eight size = start;
  Eight goal{};
  for (std::size_t n = 0; n < laneCount; ++n) goal[n] = tolerance * tolerance * start[n];
  const auto open = [&](std::size_t n) { return start[n] > 0.0 && std::isfinite(start[n]) && size[n] > goal[n]; };
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
    for (std::size_t r = rows; r-- > 0;) {
      sweeps::backwardMany(blocks(r), inverseOf(r), z_.data(), beta.data(), p_.data(), t_.data(), u_.data(),
                           r * laneStride);
    }
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
    report.converged = report.converged && size[n] <= goal[n];
  }
  return report;
}

}  // namespace calot
