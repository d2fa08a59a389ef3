// SPDX-License-Identifier: GPL-3.0-or-later
// Eigen's decompositions of small matrices, compiled once: unrolled for each size they take longer than all else here.
#pragma once

#include <Eigen/Core>

namespace calot::recorder {

/// The solution of `matrix` x = `right`, by Gauss with partial pivoting. Not finite where the matrix is singular.
Eigen::VectorXd solved(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right);

/// Not finite where the matrix is singular.
Eigen::MatrixXd inverseOf(const Eigen::MatrixXd& matrix);

struct SymmetricEigen {
  Eigen::VectorXd values;   ///< from the least
  Eigen::MatrixXd vectors;  ///< columns of length 1
};

/// @pre symmetric
SymmetricEigen eigenOf(const Eigen::MatrixXd& matrix);

}  // namespace calot::recorder
