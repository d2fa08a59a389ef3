// SPDX-License-Identifier: GPL-3.0-or-later
// Static equilibrium of a co-rotational solid of tetrahedra once more, in double over a sparse factorisation: no code
// is shared with sim/. It takes the rotation of an element in either of the two ways that "polar" stands for.
#pragma once

#include <algorithm>
#include <Eigen/Dense>
#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <vector>

#include "tests/accuracy/support/reference_element.h"

namespace calot::test {

enum class RotationRule {
  /// R = polar(F): the rotation nearest to the deformation gradient, whatever the shape at rest.
  deformationGradient,
  /// R = polar(D) polar(D0)^T, with the edges from the first node as columns of D (now) and D0 (at rest): two polar
  /// frames. It is the above for a rigid motion, and depends on the order of the nodes and on the shape at rest
  /// otherwise.
  edgeFrames
};

struct StaticBody {
  std::vector<Vec3> rest;
  std::vector<Index4> tetrahedron;
  std::vector<bool> fixed;
  double lambda = 0.0, mu = 0.0;  ///< Pa
  std::vector<Vec3> load;         ///< on the nodes (N)
};

/// The rotation of a matrix' polar decomposition; of an inverted one the nearest rotation.
inline Mat3 polarRotation(const Mat3& m) {
  const Eigen::JacobiSVD<Mat3> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 u = svd.matrixU();
  if (Mat3(u * svd.matrixV().transpose()).determinant() < 0.0) u.col(2) *= -1.0;
  return u * svd.matrixV().transpose();
}

struct StaticAnswer {
  std::vector<Vec3> position;
  int iterations = 0;
  double residual = 0.0;  ///< largest force that is left on a free node, over the largest load
};

/// Iterates x += K(R)^-1 (load + f(x)) with the rotations of x, half the way at first, until nothing moves by 1e-12 m.
inline StaticAnswer equilibrium(const StaticBody& body, RotationRule rule) {
  const std::size_t nodes = body.rest.size();
  std::vector<int> unknown(nodes, -1);
  int count = 0;
  for (std::size_t n = 0; n < nodes; ++n) {
    if (!body.fixed[n]) unknown[n] = 3 * count++;
  }
  StaticAnswer answer;
  answer.position = body.rest;
  std::vector<Eigen::Triplet<double>> entry;
  Eigen::SparseLU<Eigen::SparseMatrix<double>> factor;
  double maxLoad = 0.0;
  for (const Vec3& f : body.load) maxLoad = std::max(maxLoad, f.norm());
  for (answer.iterations = 0; answer.iterations < 200; ++answer.iterations) {
    entry.clear();
    Eigen::VectorXd left = Eigen::VectorXd::Zero(3 * count);
    for (std::size_t n = 0; n < nodes; ++n) {
      if (unknown[n] >= 0) left.segment<3>(unknown[n]) = body.load[n];
    }
    for (const Index4& t : body.tetrahedron) {
      const Mat3 before = edgesOf(body.rest, t);
      const Mat3 now = edgesOf(answer.position, t);
      const ReferenceElement element(before);
      const Mat3 r = rule == RotationRule::deformationGradient
                         ? polarRotation(now * element.inverse)
                         : Mat3(polarRotation(now) * polarRotation(before).transpose());
      const Mat3 turned = r.transpose() * now * element.inverse;
      const Mat3 strain = 0.5 * (turned + turned.transpose()) - Mat3::Identity();
      const Mat3 stress = 2.0 * body.mu * strain + body.lambda * strain.trace() * Mat3::Identity();
      for (int i = 0; i < 4; ++i) {
        const int row = unknown[static_cast<std::size_t>(t[i])];
        if (row < 0) continue;
        left.segment<3>(row) -= element.volume * (r * stress * element.gradient.col(i));
        for (int j = 0; j < 4; ++j) {
          const int column = unknown[static_cast<std::size_t>(t[j])];
          if (column < 0) continue;
          const Mat3 k = element.stiffness(i, j, r, body.lambda, body.mu);
          for (int a = 0; a < 3; ++a) {
            for (int b = 0; b < 3; ++b) entry.emplace_back(row + a, column + b, k(a, b));
          }
        }
      }
    }
    Eigen::SparseMatrix<double> matrix(3 * count, 3 * count);
    matrix.setFromTriplets(entry.begin(), entry.end());
    if (answer.iterations == 0) factor.analyzePattern(matrix);
    factor.factorize(matrix);
    const Eigen::VectorXd move = (answer.iterations < 10 ? 0.5 : 1.0) * factor.solve(left);
    for (std::size_t n = 0; n < nodes; ++n) {
      if (unknown[n] >= 0) answer.position[n] += move.segment<3>(unknown[n]);
    }
    answer.residual = left.lpNorm<Eigen::Infinity>() / maxLoad;
    if (move.lpNorm<Eigen::Infinity>() < 1e-12) break;
  }
  return answer;
}

}  // namespace calot::test
