// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/dense_contact.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <Eigen/Dense>

namespace calot::bench {

namespace {

Eigen::MatrixXd matrixOf(const OwnedProblem& problem) {
  const auto n = static_cast<Eigen::Index>(problem.free.size());
  return Eigen::Map<const Eigen::MatrixXd>(problem.compliance.data(), n, n);
}

Eigen::VectorXd freeOf(const OwnedProblem& problem) {
  return Eigen::Map<const Eigen::VectorXd>(problem.free.data(), static_cast<Eigen::Index>(problem.free.size()));
}

}  // namespace

std::vector<double> principalPivoting(const OwnedProblem& problem, int& pivots) {
  const Eigen::MatrixXd w = matrixOf(problem);
  const Eigen::VectorXd free = freeOf(problem);
  const auto n = static_cast<int>(free.size());
  std::vector<bool> active(static_cast<std::size_t>(n), false);
  Eigen::VectorXd lambda = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd gap = free;
  int fewest = n + 1;
  int patience = 10;
  for (pivots = 0;; ++pivots) {
    std::vector<int> wrong;
    for (int i = 0; i < n; ++i) {
      const bool on = active[static_cast<std::size_t>(i)];
      if (on ? lambda[i] < 0.0 : gap[i] < -1e-16) wrong.push_back(i);
    }
    if (wrong.empty()) break;
    // All at once while that gets anywhere, else the last one alone (Murty), which always ends.
    if (static_cast<int>(wrong.size()) < fewest) {
      fewest = static_cast<int>(wrong.size());
      patience = 10;
    } else if (--patience < 0) {
      wrong = {wrong.back()};
    }
    for (const int i : wrong) active[static_cast<std::size_t>(i)] = !active[static_cast<std::size_t>(i)];
    std::vector<int> in;
    for (int i = 0; i < n; ++i) {
      if (active[static_cast<std::size_t>(i)]) in.push_back(i);
    }
    lambda.setZero();
    if (!in.empty()) {
      const Eigen::MatrixXd part = w(in, in);
      const Eigen::VectorXd right = -free(in);
      const Eigen::VectorXd forces = part.llt().solve(right);
      lambda(in) = forces;
    }
    gap = w * lambda + free;
  }
  return {lambda.data(), lambda.data() + n};
}

std::vector<double> projectedFixedPoint(const OwnedProblem& problem, double tolerance) {
  constexpr int most = 2000000;
  const Eigen::MatrixXd w = matrixOf(problem);
  const Eigen::VectorXd free = freeOf(problem);
  const double s = w.cwiseAbs().rowwise().sum().maxCoeff();
  Eigen::VectorXd lambda = Eigen::VectorXd::Zero(free.size());
  for (int i = 0; i < most; ++i) {
    const Eigen::VectorXd gap = w * lambda + free;
    Eigen::VectorXd next = lambda - gap / s;
    Eigen::Index at = 0;
    for (std::size_t b = 0; b < problem.kind.size(); ++b) {
      next[at] = std::max(next[at], 0.0);
      if (problem.kind[b] == BlockKind::frictional) {
        const double bound = problem.limit[b] * next[at];
        const double size = next.segment<2>(at + 1).norm();
        if (size > bound) next.segment<2>(at + 1) *= bound / size;
      }
      at += static_cast<Eigen::Index>(blockRows(problem.kind[b]));
    }
    const double change = s * (next - lambda).cwiseAbs().maxCoeff();
    lambda = next;
    if (change <= tolerance) return {lambda.data(), lambda.data() + lambda.size()};
  }
  return {};
}

}  // namespace calot::bench
