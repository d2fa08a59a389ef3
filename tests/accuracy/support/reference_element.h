// SPDX-License-Identifier: GPL-3.0-or-later
// A linear tetrahedron at rest, worked out apart from sim/.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "sim/math/linear.h"

namespace calot::test {

/// Edges from the first corner as columns (m).
inline Mat3 edgesOf(const std::vector<Vec3>& node, const Index4& t) {
  Mat3 d;
  for (int c = 0; c < 3; ++c) {
    d.col(c) = node[static_cast<std::size_t>(t[c + 1])] - node[static_cast<std::size_t>(t[0])];
  }
  return d;
}

struct ReferenceElement {
  double volume = 0.0;                   ///< m^3
  Mat3 inverse;                          ///< of edgesOf() at rest
  Eigen::Matrix<double, 3, 4> gradient;  ///< of the shape functions, a column a corner (1/m)

  explicit ReferenceElement(const Mat3& edges) : volume(edges.determinant() / 6.0), inverse(edges.inverse()) {
    gradient.rightCols<3>() = inverse.transpose();
    gradient.col(0) = -gradient.rightCols<3>().rowwise().sum();
  }
  /// Stiffness between corners i and j, turned by r (N/m).
  [[nodiscard]] Mat3 stiffness(int i, int j, const Mat3& r, double lambda, double mu) const {
    const Vec3 gi = r * gradient.col(i);
    const Vec3 gj = r * gradient.col(j);
    return volume * (lambda * gi * gj.transpose() + mu * gj * gi.transpose() + mu * gi.dot(gj) * Mat3::Identity());
  }
};

}  // namespace calot::test
