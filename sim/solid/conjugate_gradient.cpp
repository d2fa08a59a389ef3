// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/conjugate_gradient.h"

#include <algorithm>
#include <cmath>

#include "sim/math/floating_point.h"

namespace calot {

namespace {

constexpr std::size_t slicesPerTask = 16;

std::size_t taskCount(const BlockMatrix& matrix) { return (matrix.slices() + slicesPerTask - 1) / slicesPerTask; }

/// z = D^-1 r on one slice.
CALOT_LANE_KERNEL void preconditionSlice(const float* inverse, const float* r, float* z) {
  for (std::size_t l = 0; l < laneCount; ++l) {
    const float r0 = r[l];
    const float r1 = r[8 + l];
    const float r2 = r[16 + l];
    z[l] = (inverse[l] * r0 + inverse[8 + l] * r1) + inverse[16 + l] * r2;
    z[8 + l] = (inverse[24 + l] * r0 + inverse[32 + l] * r1) + inverse[40 + l] * r2;
    z[16 + l] = (inverse[48 + l] * r0 + inverse[56 + l] * r1) + inverse[64 + l] * r2;
  }
}

}  // namespace

void ConjugateGradient::prepare(const BlockMatrix& matrix, std::span<const float> values, std::span<const int> diagonal,
                                Executor& executor, std::span<const ExtraBlock> extra) {
  extra_.assign(extra.begin(), extra.end());
  const std::size_t size = matrix.vectorSize();
  inverse_.resize(matrix.slices() * 9 * laneCount);
  for (std::vector<float>* v : {&r_, &p_, &y_, &z_}) v->resize(size * laneCount);
  partial_.resize(taskCount(matrix));
  partialMany_.resize(taskCount(matrix));
  executor.run(taskCount(matrix), [&](std::size_t task) {
    const FloatingPointScope scope;
    const std::size_t end = std::min(matrix.slices(), (task + 1) * slicesPerTask);
    for (std::size_t row = task * slicesPerTask * laneCount; row < end * laneCount; ++row) {
      float* out = inverse_.data() + row / laneCount * 9 * laneCount + row % laneCount;
      if (row >= matrix.rows()) {
        for (std::size_t i = 0; i < 9; ++i) out[i * laneCount] = 0.0F;
        continue;
      }
      const float* in = values.data() + matrix.slot(row, static_cast<std::size_t>(diagonal[row]));
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
      const double inverse = 1.0 / ((a(0, 0) * c00 + a(0, 1) * c10) + a(0, 2) * c20);
      const double c[9] = {c00, c01, c02, c10, c11, c12, c20, c21, c22};
      for (std::size_t i = 0; i < 9; ++i) out[i * laneCount] = static_cast<float>(c[i] * inverse);
    }
  });
}

/// y += extra p; returns their part of p . y.
double ConjugateGradient::addExtra() {
  double dot = 0.0;
  for (const ExtraBlock& e : extra_) {
    const float* p = p_.data() + laneOffset(e.column);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t at = laneOffset(e.row) + i * laneCount;
      const float sum =
          (e.value[3 * i] * p[0] + e.value[3 * i + 1] * p[laneCount]) + e.value[3 * i + 2] * p[2 * laneCount];
      y_[at] += sum;
      dot += static_cast<double>(p_[at]) * static_cast<double>(sum);
    }
  }
  return dot;
}

void ConjugateGradient::addExtraMany(std::array<double, laneCount>& dot) {
  for (const ExtraBlock& e : extra_) {
    const float* p = p_.data() + e.column * laneStride;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t n = 0; n < laneCount; ++n) {
        const std::size_t at = e.row * laneStride + i * laneCount + n;
        const float sum =
            (e.value[3 * i] * p[n] + e.value[3 * i + 1] * p[laneCount + n]) + e.value[3 * i + 2] * p[2 * laneCount + n];
        y_[at] += sum;
        dot[n] += static_cast<double>(p_[at]) * static_cast<double>(sum);
      }
    }
  }
}

SolveReport ConjugateGradient::solve(const BlockMatrix& matrix, std::span<const float> values, std::span<const float> b,
                                     std::span<float> x, double tolerance, std::uint32_t cap, Executor& executor) {
  const std::size_t tasks = taskCount(matrix);
  const std::size_t slices = matrix.slices();
  const auto reduce = [&](std::size_t which) {
    double sum = 0.0;
    for (std::size_t t = 0; t < tasks; ++t) sum += partial_[t][which];
    return sum;
  };
  // Of one task: x += alpha p, r -= alpha y, z = D^-1 r; sums of r.z and r.r.
  const auto update = [&](std::size_t task, float alpha) {
    std::array<double, laneCount> rz{};
    std::array<double, laneCount> rr{};
    const std::size_t end = std::min(slices, (task + 1) * slicesPerTask);
    for (std::size_t s = task * slicesPerTask; s < end; ++s) {
      const std::size_t at = s * laneStride;
      for (std::size_t i = at; i < at + laneStride; ++i) {
        x[i] += alpha * p_[i];
        r_[i] -= alpha * y_[i];
      }
      preconditionSlice(inverse_.data() + s * 9 * laneCount, r_.data() + at, z_.data() + at);
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t l = 0; l < laneCount; ++l) {
          const auto r = static_cast<double>(r_[at + i * laneCount + l]);
          rz[l] += r * static_cast<double>(z_[at + i * laneCount + l]);
          rr[l] += r * r;
        }
      }
    }
    partial_[task] = {};
    for (std::size_t l = 0; l < laneCount; ++l) {
      partial_[task][0] += rz[l];
      partial_[task][1] += rr[l];
    }
  };

  executor.run(tasks, [&](std::size_t task) {
    const FloatingPointScope scope;
    const std::size_t first = task * slicesPerTask * laneStride;
    const std::size_t last = std::min(slices, (task + 1) * slicesPerTask) * laneStride;
    for (std::size_t i = first; i < last; ++i) {
      x[i] = 0.0F;
      r_[i] = b[i];
      p_[i] = 0.0F;
      y_[i] = 0.0F;
    }
    update(task, 0.0F);
    for (std::size_t i = first; i < last; ++i) p_[i] = z_[i];
  });
  double rz = reduce(0);
  const double start = reduce(1);
  SolveReport report;
  if (!(start > 0.0)) return report;
  const double goal = tolerance * tolerance * start;
  double rr = start;
  while (rr > goal && report.iterations < cap) {
    executor.run(tasks, [&](std::size_t task) {
      const FloatingPointScope scope;
      const std::size_t end = std::min(slices, (task + 1) * slicesPerTask);
      partial_[task][0] = matrix.multiply(values, p_.data(), y_.data(), task * slicesPerTask, end);
    });
    const double curvature = reduce(0) + addExtra();
    if (!(curvature > 0.0)) break;  // not positive definite, or not a number: what is reached so far stands
    const auto alpha = static_cast<float>(rz / curvature);
    executor.run(tasks, [&](std::size_t task) {
      const FloatingPointScope scope;
      update(task, alpha);
    });
    const double next = reduce(0);
    rr = reduce(1);
    ++report.iterations;
    if (!(rr > goal)) break;
    const auto beta = static_cast<float>(next / rz);
    rz = next;
    executor.run(tasks, [&](std::size_t task) {
      const FloatingPointScope scope;
      const std::size_t last = std::min(slices, (task + 1) * slicesPerTask) * laneStride;
      for (std::size_t i = task * slicesPerTask * laneStride; i < last; ++i) p_[i] = z_[i] + beta * p_[i];
    });
  }
  report.residual = std::sqrt(rr / start);
  report.converged = rr <= goal;
  return report;
}

SolveReport ConjugateGradient::solveMany(const BlockMatrix& matrix, std::span<const float> values,
                                         std::span<const float> b, std::span<float> x, double tolerance,
                                         std::uint32_t cap, Executor& executor) {
  using Eight = std::array<double, laneCount>;
  const std::size_t tasks = taskCount(matrix);
  const std::size_t slices = matrix.slices();
  const auto reduce = [&](std::size_t which) {
    Eight sum{};
    for (std::size_t t = 0; t < tasks; ++t) {
      for (std::size_t n = 0; n < laneCount; ++n) sum[n] += partialMany_[t][which * laneCount + n];
    }
    return sum;
  };
  const auto update = [&](std::size_t task, const std::array<float, laneCount>& alpha) {
    std::array<double, 2 * laneCount> sums{};
    const std::size_t end = std::min(slices, (task + 1) * slicesPerTask);
    for (std::size_t row = task * slicesPerTask * laneCount; row < end * laneCount; ++row) {
      const std::size_t at = row * laneStride;
      const float* d = inverse_.data() + row / laneCount * 9 * laneCount + row % laneCount;
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t n = 0; n < laneCount; ++n) {
          const std::size_t k = at + i * laneCount + n;
          x[k] += alpha[n] * p_[k];
          r_[k] -= alpha[n] * y_[k];
        }
      }
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t n = 0; n < laneCount; ++n) {
          z_[at + i * laneCount + n] =
              (d[3 * i * laneCount] * r_[at + n] + d[(3 * i + 1) * laneCount] * r_[at + laneCount + n]) +
              d[(3 * i + 2) * laneCount] * r_[at + 2 * laneCount + n];
        }
      }
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t n = 0; n < laneCount; ++n) {
          const std::size_t k = at + i * laneCount + n;
          const auto r = static_cast<double>(r_[k]);
          sums[n] += r * static_cast<double>(z_[k]);
          sums[laneCount + n] += r * r;
        }
      }
    }
    partialMany_[task] = sums;
  };

  executor.run(tasks, [&](std::size_t task) {
    const FloatingPointScope scope;
    const std::size_t first = task * slicesPerTask * laneCount * laneStride;
    const std::size_t last = std::min(slices, (task + 1) * slicesPerTask) * laneCount * laneStride;
    for (std::size_t i = first; i < last; ++i) {
      x[i] = 0.0F;
      r_[i] = b[i];
      p_[i] = 0.0F;
      y_[i] = 0.0F;
    }
    update(task, {});
    for (std::size_t i = first; i < last; ++i) p_[i] = z_[i];
  });
  Eight rz = reduce(0);
  const Eight start = reduce(1);
  Eight rr = start;
  Eight goal{};
  for (std::size_t n = 0; n < laneCount; ++n) goal[n] = tolerance * tolerance * start[n];
  const auto open = [&](std::size_t n) { return start[n] > 0.0 && rr[n] > goal[n]; };
  SolveReport report;
  const auto anyOpen = [&] {
    for (std::size_t n = 0; n < laneCount; ++n) {
      if (open(n)) return true;
    }
    return false;
  };
  while (anyOpen() && report.iterations < cap) {
    executor.run(tasks, [&](std::size_t task) {
      const FloatingPointScope scope;
      const std::size_t end = std::min(slices, (task + 1) * slicesPerTask);
      partialMany_[task] = {};
      matrix.multiplyMany(values, p_.data(), y_.data(), task * slicesPerTask, end, partialMany_[task].data());
    });
    Eight curvature = reduce(0);
    addExtraMany(curvature);
    std::array<float, laneCount> alpha{};
    bool moved = false;
    for (std::size_t n = 0; n < laneCount; ++n) {
      if (!open(n) || !(curvature[n] > 0.0)) continue;
      alpha[n] = static_cast<float>(rz[n] / curvature[n]);
      moved = true;
    }
    if (!moved) break;
    executor.run(tasks, [&](std::size_t task) {
      const FloatingPointScope scope;
      update(task, alpha);
    });
    const Eight next = reduce(0);
    rr = reduce(1);
    ++report.iterations;
    std::array<float, laneCount> beta{};
    for (std::size_t n = 0; n < laneCount; ++n) {
      if (open(n) && rz[n] > 0.0) beta[n] = static_cast<float>(next[n] / rz[n]);
    }
    rz = next;
    executor.run(tasks, [&](std::size_t task) {
      const FloatingPointScope scope;
      const std::size_t last = std::min(slices, (task + 1) * slicesPerTask) * laneCount;
      for (std::size_t row = task * slicesPerTask * laneCount; row < last; ++row) {
        for (std::size_t i = 0; i < 3; ++i) {
          for (std::size_t n = 0; n < laneCount; ++n) {
            const std::size_t k = row * laneStride + i * laneCount + n;
            p_[k] = z_[k] + beta[n] * p_[k];
          }
        }
      }
    });
  }
  for (std::size_t n = 0; n < laneCount; ++n) {
    if (!(start[n] > 0.0)) continue;
    report.residual = std::max(report.residual, std::sqrt(rr[n] / start[n]));
    report.converged = report.converged && rr[n] <= goal[n];
  }
  return report;
}

}  // namespace calot
