// SPDX-License-Identifier: GPL-3.0-or-later
// Semi-smooth Newton steps on the natural map of the contact problem.
#include <algorithm>
#include <array>
#include <cmath>

#include "sim/contact/contact_solver.h"
#include "sim/math/bounds.h"
#include "sim/math/linear.h"

namespace calot {

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
      for (std::size_t j = k + 1; j < n; ++j) a[i * n + j] -= f * a[k * n + j];
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
