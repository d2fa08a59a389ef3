// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/dense_solvers.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace calot::recorder {

Eigen::VectorXd solved(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right) {
  return matrix.partialPivLu().solve(right);
}

Eigen::MatrixXd inverseOf(const Eigen::MatrixXd& matrix) { return matrix.partialPivLu().inverse(); }

SymmetricEigen eigenOf(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace calot::recorder
