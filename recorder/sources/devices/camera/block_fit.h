// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace calot::recorder {

using Block6 = Eigen::Matrix<double, 6, 1>;

/// A least-squares problem whose unknowns are a few shared ones and six of each block, as bundle adjustment has them
/// (Triggs et al. 2000, "Bundle adjustment, a modern synthesis").
struct BlockProblem {
  /// Residuals of a block; always as many for one block, and finite where the pose is in front of the camera.
  std::function<Eigen::VectorXd(std::size_t block, const Eigen::VectorXd& shared, const Block6& local)> residual;
  Eigen::VectorXd shared;     ///< start, then solution
  std::vector<Block6> local;  ///< likewise
  Eigen::VectorXd step;       ///< of the shared unknowns, for differences
  double localStep = 1e-6;
};

struct BlockSolution {
  bool converged = false;
  double residual = 0.0;        ///< root mean square
  Eigen::VectorXd uncertainty;  ///< standard deviation of each shared unknown
};

/// Levenberg and Marquardt with central differences and the Schur complement.
BlockSolution solveBlocks(BlockProblem& problem);

}  // namespace calot::recorder
