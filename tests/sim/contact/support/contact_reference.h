// SPDX-License-Identifier: GPL-3.0-or-later
// The contact problem once more, written plainly over Eigen: what a solution is, and how it is found by trying all
// sets of active rows. Shares no code with the solver.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <Eigen/Dense>
#include <string>
#include <vector>

#include "sim/contact/contact_solver.h"
#include "sim/math/random.h"

namespace calot::test {

/// A contact problem that owns its arrays.
struct OwnedProblem {
  std::vector<BlockKind> kind;
  std::vector<double> limit;
  Eigen::MatrixXd w;  // symmetric: the order of rows and columns does not matter
  Eigen::VectorXd free;

  [[nodiscard]] ContactProblem view() const {
    return {kind,
            limit,
            {w.data(), static_cast<std::size_t>(w.size())},
            {free.data(), static_cast<std::size_t>(free.size())}};
  }
  [[nodiscard]] std::size_t rows() const { return static_cast<std::size_t>(free.size()); }
  [[nodiscard]] std::vector<double> zeros() const { return std::vector<double>(rows(), 0.0); }
};

/// n unilateral rows.
inline OwnedProblem unilateralRows(const Eigen::MatrixXd& w, const Eigen::VectorXd& free) {
  const auto n = static_cast<std::size_t>(free.size());
  return {std::vector<BlockKind>(n, BlockKind::unilateral), std::vector<double>(n, 0.0), w, free};
}

/// By how much forces and gaps break the laws of contact, in metres: signs, complementarity, Coulomb's bound and its
/// direction, the ball's bound. Forces count by the block's diagonal.
inline double brokenLaws(const OwnedProblem& problem, const std::vector<double>& lambda) {
  const Eigen::Map<const Eigen::VectorXd> l(lambda.data(), static_cast<Eigen::Index>(lambda.size()));
  const Eigen::VectorXd gap = problem.w * l + problem.free;
  double worst = 0.0;
  Eigen::Index at = 0;
  // With |force| bounded: below the bound no slip, at the bound slip straight against the force.
  const auto bounded = [&](const Eigen::VectorXd& force, const Eigen::VectorXd& slip, double bound, double s) {
    const double size = force.norm();
    worst = std::max(worst, s * (size - bound));
    const Eigen::VectorXd along = size > 0.0 ? Eigen::VectorXd(force / size) : Eigen::VectorXd(0.0 * force);
    const double with = size > 0.0 ? slip.dot(along) : 0.0;
    if (size > 0.0) worst = std::max({worst, (slip - with * along).norm(), with});
    if (size == 0.0 && bound > 0.0) worst = std::max(worst, slip.norm());
    worst = std::max(worst, std::min(slip.norm(), s * (bound - size)));
  };
  for (std::size_t b = 0; b < problem.kind.size(); ++b) {
    const double limit = problem.limit[b];
    if (problem.kind[b] == BlockKind::bilateral) {
      bounded(l.segment(at, 3), gap.segment(at, 3), limit, problem.w.diagonal().segment(at, 3).mean());
    } else {
      const double d = problem.w(at, at);
      worst = std::max({worst, -d * l[at], -gap[at], std::min(d * l[at], gap[at])});
      if (problem.kind[b] == BlockKind::frictional) {
        bounded(l.segment(at + 1, 2), gap.segment(at + 1, 2), limit * l[at],
                problem.w.diagonal().segment(at + 1, 2).mean());
      }
    }
    at += static_cast<Eigen::Index>(blockRows(problem.kind[b]));
  }
  return worst;
}

/// Tries every set of active rows; for a symmetric positive definite W exactly one fits.
inline Eigen::VectorXd byEnumeration(const Eigen::MatrixXd& w, const Eigen::VectorXd& free, double tolerance = 1e-12) {
  const auto n = static_cast<int>(free.size());
  for (unsigned set = 0; set < (1U << static_cast<unsigned>(n)); ++set) {
    std::vector<int> active;
    for (int i = 0; i < n; ++i) {
      if ((set >> static_cast<unsigned>(i) & 1U) != 0) active.push_back(i);
    }
    Eigen::VectorXd lambda = Eigen::VectorXd::Zero(n);
    if (!active.empty()) {
      const Eigen::MatrixXd sub = w(active, active);
      const Eigen::VectorXd right = -free(active);
      const Eigen::VectorXd forces = sub.ldlt().solve(right);
      lambda(active) = forces;
    }
    const Eigen::VectorXd gap = w * lambda + free;
    bool fits = (lambda.array() * w.diagonal().array()).minCoeff() >= -tolerance;
    for (int i = 0; i < n; ++i) {
      if ((set >> static_cast<unsigned>(i) & 1U) == 0) fits = fits && gap[i] >= -tolerance;
    }
    if (fits) return lambda;
  }
  ADD_FAILURE() << "no set of active rows fits";
  return Eigen::VectorXd::Zero(n);
}

/// Symmetric, positive definite, with normal numbers in its factor.
inline Eigen::MatrixXd randomCompliance(Random& random, int n, double diagonal, int columns = 0) {
  Eigen::MatrixXd a(n, columns > 0 ? columns : n);
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    for (Eigen::Index j = 0; j < a.cols(); ++j) a(i, j) = random.normal();
  }
  return a * a.transpose() + diagonal * Eigen::MatrixXd::Identity(n, n);
}

}  // namespace calot::test
