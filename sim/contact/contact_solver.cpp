// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/contact_solver.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/math/bounds.h"
#include "sim/math/lanes.h"
#include "sim/math/linear.h"

namespace calot {

namespace {

constexpr double divergenceFactor = 1e3;  ///< a residual above this multiple of the warm start's is rejected

/// y += a x. Elements are independent: any vector width gives the same bits.
CALOT_LANE_KERNEL void addScaled(std::size_t n, double a, const double* __restrict x, double* __restrict y) {
  for (std::size_t i = 0; i < n; ++i) y[i] += a * x[i];
}

/// A block's rows within the problem.
struct Rows {
  const double* w;  ///< the whole matrix
  std::size_t n;    ///< its size
  std::size_t at;   ///< the block's first row
  [[nodiscard]] double operator()(std::size_t i, std::size_t j) const { return w[(at + i) * n + at + j]; }
};

Vec3 projected(const Vec3& v, double radius) {
  const double size = v.norm();
  return size > radius ? Vec3(v * (radius / size)) : v;
}

/// Tangential force of a frictional block for a given normal force, gaps at `lambda`. Tries sticking first; if that
/// force leaves the friction disc, takes one projected gradient step.
std::array<double, 2> tangential(const Rows& w, const double* lambda, const double* gap, double bound) {
  if (!(bound > 0.0)) return {0.0, 0.0};
  const double a = w(1, 1);
  const double b = w(1, 2);
  const double c = w(2, 2);
  const double determinant = a * c - b * b;
  if (determinant > 1e-12 * a * c) {
    const double x = lambda[1] - (c * gap[1] - b * gap[2]) / determinant;
    const double y = lambda[2] - (a * gap[2] - b * gap[1]) / determinant;
    if (x * x + y * y <= bound * bound) return {x, y};
  }
  const double s = std::max(a, c) + std::abs(b);  // not below the larger eigenvalue
  double x = lambda[1] - gap[1] / s;
  double y = lambda[2] - gap[2] / s;
  const double size = std::sqrt(x * x + y * y);
  if (size > bound) {
    x *= bound / size;
    y *= bound / size;
  }
  return {x, y};
}

/// Force of a bilateral block.
Vec3 bilateralForce(const Rows& w, const double* lambda, const double* gap, double limit) {
  Mat3 block;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) block(i, j) = w(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
  }
  const Vec3 now(lambda[0], lambda[1], lambda[2]);
  const Vec3 g(gap[0], gap[1], gap[2]);
  const Vec3 c0 = block.row(1).cross(block.row(2));
  const double determinant = block.row(0).dot(c0);
  const double scale = block(0, 0) * block(1, 1) * block(2, 2);
  if (determinant > 1e-12 * scale) {
    const Vec3 c1 = block.row(2).cross(block.row(0));
    const Vec3 c2 = block.row(0).cross(block.row(1));
    const Vec3 exact = now - (c0 * g[0] + c1 * g[1] + c2 * g[2]) / determinant;
    if (exact.squaredNorm() <= limit * limit) return exact;
  }
  const double s = block(0, 0) + block(1, 1) + block(2, 2);
  return projected(now - g / s, limit);
}

double blockResidual(BlockKind kind, double limit, const Rows& w, const double* lambda, const double* gap) {
  if (kind == BlockKind::bilateral) {
    const double s = (w(0, 0) + w(1, 1) + w(2, 2)) / 3.0;
    const Vec3 l(s * lambda[0], s * lambda[1], s * lambda[2]);
    return (l - projected(l - Vec3(gap[0], gap[1], gap[2]), s * limit)).norm();
  }
  const double normal = std::abs(std::min(w(0, 0) * lambda[0], gap[0]));
  if (kind == BlockKind::unilateral) return normal;
  const double s = 0.5 * (w(1, 1) + w(2, 2));
  const Vec3 l(s * lambda[1], s * lambda[2], 0.0);
  const double slip = (l - projected(l - Vec3(gap[1], gap[2], 0.0), s * limit * notNegative(lambda[0]))).norm();
  return std::max(normal, slip);
}

}  // namespace

void projectOntoFrictionCone(BlockKind kind, double limit, std::span<double> lambda) {
  if (kind == BlockKind::bilateral) {
    const Vec3 l = projected(Vec3(lambda[0], lambda[1], lambda[2]), limit);
    for (std::size_t i = 0; i < 3; ++i) lambda[i] = l[static_cast<int>(i)];
    return;
  }
  lambda[0] = notNegative(lambda[0]);
  if (kind == BlockKind::unilateral) return;
  const Vec3 t = projected(Vec3(lambda[1], lambda[2], 0.0), limit * lambda[0]);
  lambda[1] = t[0];
  lambda[2] = t[1];
}

void evaluateGaps(const ContactProblem& problem, std::span<const double> lambda, std::span<double> gap) {
  const std::size_t n = problem.free.size();
  for (std::size_t i = 0; i < n; ++i) gap[i] = problem.free[i];
  for (std::size_t j = 0; j < n; ++j) {
    if (lambda[j] != 0.0) addScaled(n, lambda[j], problem.compliance.data() + j * n, gap.data());
  }
}

double naturalResidual(const ContactProblem& problem, std::span<const double> lambda, std::span<const double> gap) {
  double residual = 0.0;
  std::size_t at = 0;
  for (std::size_t b = 0; b < problem.kind.size(); ++b) {
    const Rows w{problem.compliance.data(), problem.free.size(), at};
    residual =
        std::max(residual, blockResidual(problem.kind[b], problem.limit[b], w, lambda.data() + at, gap.data() + at));
    at += blockRows(problem.kind[b]);
  }
  return residual;
}

ContactReport sweepContacts(const ContactProblem& problem, std::span<double> lambda, std::span<double> gap,
                            double tolerance, std::uint32_t cap) {
  const std::size_t n = problem.free.size();
  const double* w = problem.compliance.data();
  const auto change = [&](std::size_t row, double to) {
    const double by = to - lambda[row];
    if (by == 0.0) return;
    lambda[row] = to;
    addScaled(n, by, w + row * n, gap.data());
  };
  for (std::size_t b = 0, at = 0; b < problem.kind.size(); at += blockRows(problem.kind[b]), ++b) {
    projectOntoFrictionCone(problem.kind[b], problem.limit[b], lambda.subspan(at, blockRows(problem.kind[b])));
  }
  evaluateGaps(problem, lambda, gap);
  ContactReport report;
  for (;;) {
    report.residual = naturalResidual(problem, lambda, gap);
    if (report.residual <= tolerance || report.sweeps >= cap) break;
    for (std::size_t b = 0, at = 0; b < problem.kind.size(); at += blockRows(problem.kind[b]), ++b) {
      const Rows rows{w, n, at};
      if (problem.kind[b] == BlockKind::bilateral) {
        const Vec3 to = bilateralForce(rows, lambda.data() + at, gap.data() + at, problem.limit[b]);
        for (std::size_t i = 0; i < 3; ++i) change(at + i, to[static_cast<int>(i)]);
        continue;
      }
      change(at, std::max(0.0, lambda[at] - gap[at] / rows(0, 0)));
      if (problem.kind[b] == BlockKind::unilateral) continue;
      const auto [x, y] = tangential(rows, lambda.data() + at, gap.data() + at, problem.limit[b] * lambda[at]);
      change(at + 1, x);
      change(at + 2, y);
    }
    ++report.sweeps;
  }
  report.converged = report.residual <= tolerance;
  return report;
}

ContactReport ContactSolver::solve(const ContactProblem& problem, std::span<double> lambda, std::span<double> gap,
                                   double tolerance, std::uint32_t cap) {
  start_.assign(lambda.begin(), lambda.end());
  const ContactReport before = sweepContacts(problem, start_, gap, tolerance, 0);
  ContactReport report = sweepContacts(problem, lambda, gap, tolerance, cap);
  if (!report.converged) newton(problem, lambda, gap, tolerance, report);
  if (!(report.residual <= divergenceFactor * before.residual)) {
    std::copy(start_.begin(), start_.end(), lambda.begin());
    evaluateGaps(problem, lambda, gap);
    report.residual = before.residual;
    report.converged = before.converged;
  }
  return report;
}

}  // namespace calot
