// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/contact_solver.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/math/linear.h"
#include "sim/math/vectors.h"

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

// Semi-smooth Newton steps on the natural map of the contact problem.

namespace {

/// Gaussian elimination with partial pivoting (first of equals). @returns false where the matrix is singular.
bool eliminate(std::size_t n, std::vector<double>& a, std::vector<double>& b) {
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t best = k;
    for (std::size_t i = k + 1; i < n; ++i) {
      if (std::abs(a[i * n + k]) > std::abs(a[best * n + k])) best = i;
    }
    if (!(std::abs(a[best * n + k]) > 1e-300)) return false;
    if (best != k) {
      for (std::size_t j = k; j < n; ++j) std::swap(a[k * n + j], a[best * n + j]);
      std::swap(b[k], b[best]);
    }
    for (std::size_t i = k + 1; i < n; ++i) {
      const double f = a[i * n + k] / a[k * n + k];
      if (f == 0.0) continue;
      addScaled(n - k - 1, -f, a.data() + k * n + k + 1, a.data() + i * n + k + 1);
      b[i] -= f * b[k];
    }
  }
  for (std::size_t i = n; i-- > 0;) {
    double v = b[i];
    for (std::size_t j = i + 1; j < n; ++j) v -= a[i * n + j] * b[j];
    b[i] = v / a[i * n + i];
  }
  return true;
}

}  // namespace

/// One Newton direction into right_, from the branch of the natural map that the iterate is on.
bool ContactSolver::direction(const ContactProblem& problem, std::span<const double> lambda,
                              std::span<const double> gap) {
  const std::size_t n = problem.free.size();
  const double* w = problem.compliance.data();
  matrix_.assign(n * n, 0.0);
  right_.assign(n, 0.0);
  const auto closeRow = [&](std::size_t row) {  // gap = 0
    std::copy_n(w + row * n, n, matrix_.begin() + static_cast<std::ptrdiff_t>(row * n));
    right_[row] = -gap[row];
  };
  const auto openRow = [&](std::size_t row) {  // lambda = 0
    matrix_[row * n + row] = w[row * n + row];
    right_[row] = -w[row * n + row] * lambda[row];
  };
  // lambda_k = bound u with u the direction of v = s lambda - gap over `count` rows from `first`; the bound follows
  // lambda[normal] times mu where there is one.
  const auto slide = [&](std::size_t first, std::size_t count, double s, double bound, std::size_t normal, double mu) {
    Vec3 v = Vec3::Zero();
    for (std::size_t i = 0; i < count; ++i) v[static_cast<int>(i)] = s * lambda[first + i] - gap[first + i];
    const double size = v.norm();
    const Vec3 u = size > 0.0 ? Vec3(v / size) : Vec3::Zero();
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t row = first + i;
      const double ui = u[static_cast<int>(i)];
      double* to = matrix_.data() + row * n;
      to[row] += s;
      right_[row] = -s * (lambda[row] - bound * ui);
      if (mu > 0.0) to[normal] -= s * mu * ui;
      if (!(size > 0.0)) continue;
      for (std::size_t j = 0; j < count; ++j) {
        const double p = s * bound / size * ((i == j ? 1.0 : 0.0) - ui * u[static_cast<int>(j)]);
        to[first + j] -= p * s;
        for (std::size_t k = 0; k < n; ++k) to[k] += p * w[(first + j) * n + k];
      }
    }
  };
  for (std::size_t b = 0, at = 0; b < problem.kind.size(); at += blockRows(problem.kind[b]), ++b) {
    const double limit = problem.limit[b];
    if (problem.kind[b] == BlockKind::bilateral) {
      const double s = (w[at * n + at] + w[(at + 1) * n + at + 1] + w[(at + 2) * n + at + 2]) / 3.0;
      const Vec3 v(s * lambda[at] - gap[at], s * lambda[at + 1] - gap[at + 1], s * lambda[at + 2] - gap[at + 2]);
      if (v.norm() <= s * limit) {
        for (std::size_t i = 0; i < 3; ++i) closeRow(at + i);
      } else {
        slide(at, 3, s, limit, at, 0.0);
      }
      continue;
    }
    const bool closed = w[at * n + at] * lambda[at] - gap[at] > 0.0;
    if (closed) {
      closeRow(at);
    } else {
      openRow(at);
    }
    if (problem.kind[b] == BlockKind::unilateral) continue;
    const double bound = limit * notNegative(lambda[at]);
    const double s = 0.5 * (w[(at + 1) * n + at + 1] + w[(at + 2) * n + at + 2]);
    const double x = s * lambda[at + 1] - gap[at + 1];
    const double y = s * lambda[at + 2] - gap[at + 2];
    if (!closed || !(limit > 0.0)) {
      openRow(at + 1);
      openRow(at + 2);
    } else if (x * x + y * y <= s * s * bound * bound) {
      closeRow(at + 1);
      closeRow(at + 2);
    } else {
      slide(at + 1, 2, s, bound, at, limit);
    }
  }
  return eliminate(n, matrix_, right_);
}

void ContactSolver::newton(const ContactProblem& problem, std::span<double> lambda, std::span<double> gap,
                           double tolerance, ContactReport& report) {
  const std::size_t n = problem.free.size();
  trial_.assign(lambda.begin(), lambda.end());
  trialGap_.assign(gap.begin(), gap.end());
  std::vector<double> from(n);
  double reached = report.residual;
  for (std::uint32_t step = 0; step < maxNewtonSteps && report.residual > tolerance; ++step) {
    ++report.newtonSteps;
    if (!direction(problem, trial_, trialGap_)) break;
    from = trial_;
    // Try the full step first. If no shorter step reduces the residual, take the full one anyway: it leads to
    // a different active set.
    double length = 1.0;
    double best = 1e300;
    double bestLength = 1.0;
    for (int attempt = 0; attempt < 4; ++attempt, length *= 0.5) {
      for (std::size_t i = 0; i < n; ++i) trial_[i] = from[i] + length * right_[i];
      evaluateGaps(problem, trial_, trialGap_);
      const double residual = naturalResidual(problem, trial_, trialGap_);
      if (residual < best) {
        best = residual;
        bestLength = length;
      }
      if (residual < reached) break;
    }
    const double taken = best < reached ? bestLength : 1.0;
    for (std::size_t i = 0; i < n; ++i) trial_[i] = from[i] + taken * right_[i];
    evaluateGaps(problem, trial_, trialGap_);
    reached = naturalResidual(problem, trial_, trialGap_);
    if (!(reached < 1e6)) break;
    if (reached < report.residual) {
      report.residual = reached;
      std::copy(trial_.begin(), trial_.end(), lambda.begin());
      std::copy(trialGap_.begin(), trialGap_.end(), gap.begin());
    }
  }
  // Within the tolerance, a force may violate its bound.
  for (std::size_t b = 0, at = 0; b < problem.kind.size(); at += blockRows(problem.kind[b]), ++b) {
    projectOntoFrictionCone(problem.kind[b], problem.limit[b], lambda.subspan(at, blockRows(problem.kind[b])));
  }
  evaluateGaps(problem, lambda, gap);
  report.residual = naturalResidual(problem, lambda, gap);
  report.converged = report.residual <= tolerance;
}

}  // namespace calot
