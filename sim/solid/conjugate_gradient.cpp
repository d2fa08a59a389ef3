// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/conjugate_gradient.h"

#include <algorithm>
#include <cmath>

#include "sim/math/floating_point.h"
#include "sim/solid/sweeps.h"

namespace calot {

namespace {

constexpr std::size_t slicesPerPiece = 16;
/// A matrix of so few slices is swept by one task: handing a few slices on costs more than they do.
constexpr std::size_t slicesOfOneTask = 64;

double sumOf(const std::array<double, laneCount>& lanes) {
  double sum = 0.0;
  for (const double lane : lanes) sum += lane;
  return sum;
}

}  // namespace

template <class F>
void ConjugateGradient::run(Order order, Executor& executor, F&& work) const {
  const std::size_t pieces = piece_.size();
  if (pieces == 0) return;
  if (piece_.back().last <= slicesOfOneTask) {
    const FloatingPointScope scope;
    for (std::size_t i = 0; i < pieces; ++i) work(order == Order::descending ? pieces - 1 - i : i);
    return;
  }
  const auto part = [&](std::size_t first, std::size_t last) {
    executor.run(last - first, [&](std::size_t i) {
      const FloatingPointScope scope;
      work(first + i);
    });
  };
  if (order == Order::any) return part(0, pieces);
  const std::size_t colours = colourPiece_.size() - 1;
  for (std::size_t i = 0; i < colours; ++i) {
    const std::size_t colour = order == Order::ascending ? i : colours - 1 - i;
    part(colourPiece_[colour], colourPiece_[colour + 1]);
  }
}

void ConjugateGradient::prepare(const BlockMatrix& matrix, std::span<const float> values, Executor& executor,
                                std::span<const ExtraBlock> extra) {
  extra_.assign(extra.begin(), extra.end());
  piece_.clear();
  colourPiece_.assign(1, 0);
  for (std::size_t colour = 0; colour + 1 < matrix.colourStart().size(); ++colour) {
    const std::size_t last = matrix.colourStart()[colour + 1];
    for (std::size_t s = matrix.colourStart()[colour]; s < last; s += slicesPerPiece) {
      piece_.push_back({s, std::min(last, s + slicesPerPiece)});
    }
    colourPiece_.push_back(piece_.size());
  }
  partial_.resize(piece_.size());
  inverse_.resize(matrix.slices() * 9 * laneCount);
  run(Order::any, executor, [&](std::size_t piece) {
    for (std::size_t row = piece_[piece].first * laneCount; row < piece_[piece].last * laneCount; ++row) {
      const std::size_t lane = row % laneCount;
      float* out = inverse_.data() + row / laneCount * 9 * laneCount + lane;
      const float* in = values.data() + matrix.diagonal(row / laneCount) + lane;
      const auto a = [&](std::size_t i, std::size_t j) { return static_cast<double>(in[(3 * i + j) * laneCount]); };
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
      const double inverse = determinant == 0.0 ? 0.0 : 1.0 / determinant;  // a row that only fills a slice up
      const double c[9] = {c00, c01, c02, c10, c11, c12, c20, c21, c22};
      for (std::size_t i = 0; i < 9; ++i) out[i * laneCount] = static_cast<float>(c[i] * inverse);
    }
  });
}

/// u += E t.
void ConjugateGradient::addExtra() {
  for (const ExtraBlock& e : extra_) {
    const float* t = t_.data() + laneOffset(e.column);
    for (std::size_t i = 0; i < 3; ++i) {
      u_[laneOffset(e.row) + i * laneCount] +=
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
  for (std::vector<float>* v : {&r_, &z_, &p_, &t_, &u_, &s_}) v->assign(size, 0.0F);
}

SolveReport ConjugateGradient::solve(const BlockMatrix& matrix, std::span<const float> values, std::span<const float> b,
                                     std::span<float> x, double tolerance, std::uint32_t cap, Executor& executor) {
  using Lanes = std::array<float, laneCount>;
  clear(matrix.vectorSize());
  std::fill(x.begin(), x.end(), 0.0F);
  const auto blocks = [&](const BlockMatrix::Part& part) {
    return sweeps::Blocks{values.data() + part.value(), matrix.column(part.first), part.width};
  };
  const auto sum = [this] {
    double total = 0.0;
    for (const Eight& piece : partial_) total += sumOf(piece);
    return total;
  };
  const auto forward = [&](const float* u, float* s) {
    run(Order::ascending, executor, [&, u, s](std::size_t piece) {
      partial_[piece] = {};
      for (std::size_t i = piece_[piece].first; i < piece_[piece].last; ++i) {
        sweeps::forward(blocks(matrix.lower(i)), inverse_.data() + i * 9 * laneCount, u, s, p_.data(), t_.data(),
                        partial_[piece].data(), i * laneStride);
      }
    });
  };
  const auto update = [&](float by) {
    Lanes alpha;
    alpha.fill(by);
    run(Order::any, executor, [&](std::size_t piece) {
      partial_[piece] = {};
      for (std::size_t i = piece_[piece].first; i < piece_[piece].last; ++i) {
        sweeps::update(values.data() + matrix.diagonal(i), alpha.data(), t_.data(), s_.data(), x.data(), r_.data(),
                       z_.data(), partial_[piece].data(), i * laneStride);
      }
    });
    return sum();
  };

  forward(b.data(), r_.data());
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
    run(Order::descending, executor, [&](std::size_t piece) {
      for (std::size_t i = piece_[piece].first; i < piece_[piece].last; ++i) {
        sweeps::backward(blocks(matrix.upper(i)), inverse_.data() + i * 9 * laneCount, z_.data(), beta.data(),
                         p_.data(), t_.data(), u_.data(), i * laneStride);
      }
    });
    addExtra();
    forward(u_.data(), s_.data());
    const double curvature = sum();
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
                                         std::uint32_t cap, Executor& executor) {
  using Lanes = std::array<float, laneCount>;
  clear(matrix.vectorSize() * laneCount);
  std::fill(x.begin(), x.end(), 0.0F);
  const auto blocks = [&](const BlockMatrix::Part& part, std::size_t lane) {
    return sweeps::Blocks{values.data() + part.value() + lane, matrix.column(part.first) + lane, part.width};
  };
  /// Calls row(number, slice, lane) for the rows of a piece.
  const auto forRows = [&](std::size_t piece, auto&& row) {
    for (std::size_t r = piece_[piece].first * laneCount; r < piece_[piece].last * laneCount; ++r) {
      row(r, r / laneCount, r % laneCount);
    }
  };
  const auto sum = [this] {
    Eight total{};
    for (const Eight& piece : partial_) {
      for (std::size_t n = 0; n < laneCount; ++n) total[n] += piece[n];
    }
    return total;
  };
  const auto forward = [&](const float* u, float* s) {
    run(Order::ascending, executor, [&, u, s](std::size_t piece) {
      partial_[piece] = {};
      forRows(piece, [&](std::size_t r, std::size_t slice, std::size_t lane) {
        sweeps::forwardMany(blocks(matrix.lower(slice), lane), inverse_.data() + slice * 9 * laneCount + lane, u, s,
                            p_.data(), t_.data(), partial_[piece].data(), r * laneStride);
      });
    });
  };
  const auto update = [&](const Lanes& alpha) {
    run(Order::any, executor, [&](std::size_t piece) {
      partial_[piece] = {};
      forRows(piece, [&](std::size_t r, std::size_t slice, std::size_t lane) {
        sweeps::updateMany(values.data() + matrix.diagonal(slice) + lane, alpha.data(), t_.data(), s_.data(), x.data(),
                           r_.data(), z_.data(), partial_[piece].data(), r * laneStride);
      });
    });
    return sum();
  };

  forward(b.data(), r_.data());
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
    run(Order::descending, executor, [&](std::size_t piece) {
      forRows(piece, [&](std::size_t r, std::size_t slice, std::size_t lane) {
        sweeps::backwardMany(blocks(matrix.upper(slice), lane), inverse_.data() + slice * 9 * laneCount + lane,
                             z_.data(), beta.data(), p_.data(), t_.data(), u_.data(), r * laneStride);
      });
    });
    addExtraMany();
    forward(u_.data(), s_.data());
    const Eight curvature = sum();
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
