// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/camera/block_fit.h"

#include <algorithm>
#include <cmath>
#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace calot::recorder {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
constexpr int mostIterations = 60;

struct BlockTerms {
  Matrix6 own;
  Eigen::MatrixXd across;  // shared x 6
  Block6 gradient;
};

struct BlockSystem {
  Eigen::MatrixXd shared;
  Eigen::VectorXd gradient;
  std::vector<BlockTerms> block;
};

double costOf(const BlockProblem& p, const Eigen::VectorXd& shared, const std::vector<Block6>& local,
              Eigen::Index& count) {
  double cost = 0.0;
  count = 0;
  for (std::size_t b = 0; b < local.size(); ++b) {
    const Eigen::VectorXd r = p.residual(b, shared, local[b]);
    cost += r.squaredNorm();
    count += r.size();
  }
  return cost;
}

BlockSystem systemOf(const BlockProblem& p) {
  const Eigen::Index n = p.shared.size();
  BlockSystem out{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n), {}};
  for (std::size_t b = 0; b < p.local.size(); ++b) {
    const Eigen::VectorXd r = p.residual(b, p.shared, p.local[b]);
    Eigen::MatrixXd toShared(r.size(), n), toLocal(r.size(), 6);
    for (Eigen::Index i = 0; i < n; ++i) {
      Eigen::VectorXd up = p.shared, down = p.shared;
      up[i] += p.step[i];
      down[i] -= p.step[i];
      toShared.col(i) = (p.residual(b, up, p.local[b]) - p.residual(b, down, p.local[b])) / (2.0 * p.step[i]);
    }
    for (Eigen::Index i = 0; i < 6; ++i) {
      Block6 up = p.local[b], down = p.local[b];
      up[i] += p.localStep;
      down[i] -= p.localStep;
      toLocal.col(i) = (p.residual(b, p.shared, up) - p.residual(b, p.shared, down)) / (2.0 * p.localStep);
    }
    out.shared += toShared.transpose() * toShared;
    out.gradient += toShared.transpose() * r;
    out.block.push_back({toLocal.transpose() * toLocal, toShared.transpose() * toLocal, toLocal.transpose() * r});
  }
  return out;
}

/// Normal matrix of the shared unknowns, and its right side, after the blocks' own are eliminated.
void reduce(const BlockSystem& s, double damping, Eigen::MatrixXd& matrix, Eigen::VectorXd& right) {
  matrix = s.shared;
  matrix.diagonal() += damping * s.shared.diagonal();
  right = -s.gradient;
  for (const BlockTerms& b : s.block) {
    Matrix6 own = b.own;
    own.diagonal() += damping * b.own.diagonal();
    const Matrix6 inverse = own.inverse();
    matrix -= b.across * inverse * b.across.transpose();
    right += b.across * (inverse * b.gradient);
  }
}

}  // namespace

BlockSolution solveBlocks(BlockProblem& problem) {
  Eigen::Index count = 0;
  double cost = costOf(problem, problem.shared, problem.local, count);
  double damping = 1e-3;
  BlockSolution out;
  for (int iteration = 0; iteration < mostIterations && !out.converged && std::isfinite(cost); ++iteration) {
    const BlockSystem system = systemOf(problem);
    for (;;) {
      Eigen::MatrixXd matrix;
      Eigen::VectorXd right;
      reduce(system, damping, matrix, right);
      const Eigen::VectorXd step = matrix.ldlt().solve(right);
      const Eigen::VectorXd shared = problem.shared + step;
      std::vector<Block6> local = problem.local;
      for (std::size_t b = 0; b < local.size(); ++b) {
        const BlockTerms& t = system.block[b];
        Matrix6 own = t.own;
        own.diagonal() += damping * t.own.diagonal();
        local[b] += own.ldlt().solve(Block6(-t.gradient - t.across.transpose() * step));
      }
      Eigen::Index ignored = 0;
      const double next = costOf(problem, shared, local, ignored);
      if (std::isfinite(next) && next <= cost) {
        out.converged = cost - next <= 1e-10 * (1.0 + cost);
        problem.shared = shared;
        problem.local = std::move(local);
        cost = next;
        damping = std::max(1e-12, 0.1 * damping);
        break;
      }
      damping *= 10.0;
      if (damping > 1e9) {
        out.converged = true;  // no step is downhill
        break;
      }
    }
  }
  if (!std::isfinite(cost) || count == 0) return {};
  const auto unknowns = problem.shared.size() + 6 * static_cast<Eigen::Index>(problem.local.size());
  out.residual = std::sqrt(2.0 * cost / static_cast<double>(count));  // of points, which have two residuals each
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
  reduce(systemOf(problem), 0.0, matrix, right);
  const double variance = cost / static_cast<double>(std::max<Eigen::Index>(1, count - unknowns));
  out.uncertainty = (variance * matrix.inverse().diagonal()).cwiseMax(0.0).cwiseSqrt();
  return out;
}

}  // namespace calot::recorder
