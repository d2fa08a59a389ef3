// SPDX-License-Identifier: GPL-3.0-or-later
// Block matrix and conjugate gradients against dense algebra in double.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <Eigen/Dense>
#include <set>
#include <vector>

#include "sim/math/random.h"
#include "sim/solid/block_matrix.h"
#include "sim/solid/conjugate_gradient.h"

namespace calot {
namespace {

/// A random symmetric positive definite block system with least eigenvalue of at least 1: the identity and a sum of
/// G^T G over random pairs of rows.
struct System {
  std::vector<std::vector<int>> columns;
  std::vector<int> diagonal;
  BlockMatrix matrix;
  std::vector<float> values;
  Eigen::MatrixXd dense;  // of the float values

  System(int rows, int pairs, Random& random) {
    dense = Eigen::MatrixXd::Identity(3 * rows, 3 * rows);
    std::vector<std::set<int>> pattern(static_cast<std::size_t>(rows));
    for (int r = 0; r < rows; ++r) pattern[static_cast<std::size_t>(r)].insert(r);
    for (int k = 0; k < pairs; ++k) {
      const auto i = static_cast<int>(random.uniform() * rows);
      const auto j = static_cast<int>(random.uniform() * rows);
      if (i == j) continue;
      Eigen::Matrix<double, 3, 6> g;
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 6; ++b) g(a, b) = random.normal();
      }
      const Eigen::Matrix<double, 6, 6> block = g.transpose() * g;
      const int at[2] = {i, j};
      for (int a = 0; a < 2; ++a) {
        for (int b = 0; b < 2; ++b) dense.block<3, 3>(3 * at[a], 3 * at[b]) += block.block<3, 3>(3 * a, 3 * b);
      }
      pattern[static_cast<std::size_t>(i)].insert(j);
      pattern[static_cast<std::size_t>(j)].insert(i);
    }
    for (const std::set<int>& row : pattern) columns.emplace_back(row.begin(), row.end());
    matrix = BlockMatrix(columns);
    values.assign(matrix.valueCount(), 0.0F);
    for (int r = 0; r < rows; ++r) {
      const std::vector<int>& row = columns[static_cast<std::size_t>(r)];
      for (std::size_t k = 0; k < row.size(); ++k) {
        if (row[k] == r) diagonal.push_back(static_cast<int>(k));
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) {
            double& entry = dense(3 * r + i, 3 * row[k] + j);
            const auto value = static_cast<float>(entry);
            values[matrix.slot(static_cast<std::size_t>(r), k) + 8 * static_cast<std::size_t>(3 * i + j)] = value;
            entry = static_cast<double>(value);
          }
        }
      }
    }
  }

  [[nodiscard]] int rows() const { return static_cast<int>(columns.size()); }
  [[nodiscard]] std::vector<float> packed(const Eigen::VectorXd& v) const {
    std::vector<float> out(matrix.vectorSize(), 0.0F);
    for (int r = 0; r < rows(); ++r) {
      for (int i = 0; i < 3; ++i) {
        out[laneOffset(static_cast<std::size_t>(r)) + 8 * static_cast<std::size_t>(i)] =
            static_cast<float>(v[3 * r + i]);
      }
    }
    return out;
  }
  [[nodiscard]] Eigen::VectorXd unpacked(const std::vector<float>& v) const {
    Eigen::VectorXd out(3 * rows());
    for (int r = 0; r < rows(); ++r) {
      for (int i = 0; i < 3; ++i) {
        out[3 * r + i] =
            static_cast<double>(v[laneOffset(static_cast<std::size_t>(r)) + 8 * static_cast<std::size_t>(i)]);
      }
    }
    return out;
  }
  static std::size_t atMany(int row, int i, int k) {
    return static_cast<std::size_t>(row) * laneStride + 8 * static_cast<std::size_t>(i) + static_cast<std::size_t>(k);
  }
  [[nodiscard]] std::vector<float> packedMany(const Eigen::MatrixXd& v) const {
    std::vector<float> out(matrix.vectorSize() * laneCount, 0.0F);
    for (int r = 0; r < rows(); ++r) {
      for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < v.cols(); ++k) out[atMany(r, i, k)] = static_cast<float>(v(3 * r + i, k));
      }
    }
    return out;
  }
  [[nodiscard]] Eigen::VectorXd unpackedMany(const std::vector<float>& v, int k) const {
    Eigen::VectorXd out(3 * rows());
    for (int r = 0; r < rows(); ++r) {
      for (int i = 0; i < 3; ++i) out[3 * r + i] = static_cast<double>(v[atMany(r, i, k)]);
    }
    return out;
  }
};

Eigen::VectorXd randomVector(int size, Random& random) {
  Eigen::VectorXd v(size);
  for (int i = 0; i < size; ++i) v[i] = static_cast<double>(static_cast<float>(random.normal()));
  return v;
}

/// One row, less than a slice, whole slices, one more, and more slices than one task takes.
constexpr int sizes[] = {1, 5, 8, 9, 16, 31, 140};

TEST(BlockMatrix, MultipliesAsTheDenseMatrix) {
  SCOPED_TRACE("seed 31");
  Random random(31);
  for (const int rows : sizes) {
    const System system(rows, 3 * rows, random);
    const BlockMatrix& matrix = system.matrix;
    EXPECT_EQ(matrix.rows(), static_cast<std::size_t>(rows));
    EXPECT_EQ(matrix.slices(), laneGroups(static_cast<std::size_t>(rows)));
    const Eigen::VectorXd x = randomVector(3 * rows, random);
    const std::vector<float> packed = system.packed(x);
    std::vector<float> y(matrix.vectorSize(), 9.0F);
    // Slice by slice, as tasks do: the parts add up.
    double dot = 0.0;
    for (std::size_t s = 0; s < matrix.slices(); ++s)
      dot += matrix.multiply(system.values, packed.data(), y.data(), s, s + 1);
    const Eigen::VectorXd expected = system.dense * x;
    const double scale = expected.cwiseAbs().maxCoeff();
    EXPECT_LT((system.unpacked(y) - expected).cwiseAbs().maxCoeff(), 2e-6 * scale) << rows << " rows";
    EXPECT_NEAR(dot, x.dot(expected), 2e-6 * x.norm() * expected.norm()) << rows << " rows";
    for (std::size_t r = static_cast<std::size_t>(rows); r < matrix.slices() * laneCount; ++r) {
      for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(y[laneOffset(r) + 8 * i], 0.0F) << "padding row " << r;
    }
  }
}

TEST(BlockMatrix, EightVectorsAsOneAfterTheOther) {
  SCOPED_TRACE("seed 32");
  Random random(32);
  for (const int rows : sizes) {
    const System system(rows, 3 * rows, random);
    Eigen::MatrixXd x(3 * rows, laneCount);
    for (int k = 0; k < laneCount; ++k) x.col(k) = randomVector(3 * rows, random);
    const std::vector<float> packed = system.packedMany(x);
    std::vector<float> y(packed.size(), 9.0F);
    std::array<double, laneCount> dot{};
    system.matrix.multiplyMany(system.values, packed.data(), y.data(), 0, system.matrix.slices(), dot.data());
    for (int k = 0; k < laneCount; ++k) {
      std::vector<float> one(system.matrix.vectorSize());
      const std::vector<float> column = system.packed(x.col(k));
      const double oneDot = system.matrix.multiply(system.values, column.data(), one.data(), 0, system.matrix.slices());
      const Eigen::VectorXd a = system.unpacked(one);
      const Eigen::VectorXd b = system.unpackedMany(y, k);
      EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-6 * a.cwiseAbs().maxCoeff()) << rows << " rows, vector " << k;
      EXPECT_NEAR(dot[static_cast<std::size_t>(k)], oneDot, 1e-6 * (x.col(k).norm() * a.norm()));
    }
  }
}

/// With no eigenvalue below 1, |x - x*| <= |b - A x|: the tolerance bounds the error itself.
TEST(ConjugateGradient, AgreesWithDenseFactorisation) {
  SCOPED_TRACE("seed 33");
  Random random(33);
  SerialExecutor executor;
  ConjugateGradient cg;  // one for all sizes: what an earlier system left behind must not matter
  for (const int rows : sizes) {
    const System system(rows, 2 * rows, random);
    const Eigen::VectorXd b = randomVector(3 * rows, random);
    const Eigen::VectorXd expected = system.dense.ldlt().solve(b);
    std::vector<float> x(system.matrix.vectorSize(), 7.0F);
    cg.prepare(system.matrix, system.values, system.diagonal, executor);
    constexpr double tolerance = 1e-5;
    const SolveReport report = cg.solve(system.matrix, system.values, system.packed(b), x, tolerance, 1000, executor);
    EXPECT_TRUE(report.converged) << rows << " rows";
    EXPECT_LE(report.residual, tolerance);
    EXPECT_GT(report.iterations, 0U);
    const Eigen::VectorXd found = system.unpacked(x);
    EXPECT_LT((b - system.dense * found).norm(), 2.0 * tolerance * b.norm()) << rows << " rows: residual by recursion";
    EXPECT_LT((found - expected).norm(), 2.0 * tolerance * b.norm()) << rows << " rows";
    for (std::size_t r = static_cast<std::size_t>(rows); r < system.matrix.slices() * laneCount; ++r) {
      for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(x[laneOffset(r) + 8 * i], 0.0F) << "padding row " << r;
    }
  }
}

TEST(ConjugateGradient, EightRightHandSidesWithZerosAmongThem) {
  SCOPED_TRACE("seed 34");
  Random random(34);
  SerialExecutor executor;
  ConjugateGradient cg;
  for (const int rows : sizes) {
    const System system(rows, 2 * rows, random);
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(3 * rows, laneCount);
    for (const int k : {0, 1, 3, 6}) b.col(k) = randomVector(3 * rows, random) * (k == 3 ? 1e-6 : 1.0);
    std::vector<float> x(system.matrix.vectorSize() * laneCount, 7.0F);
    cg.prepare(system.matrix, system.values, system.diagonal, executor);
    constexpr double tolerance = 1e-5;
    const SolveReport report =
        cg.solveMany(system.matrix, system.values, system.packedMany(b), x, tolerance, 1000, executor);
    EXPECT_TRUE(report.converged) << rows << " rows";
    EXPECT_LE(report.residual, tolerance);
    const Eigen::MatrixXd expected = system.dense.ldlt().solve(b);
    for (int k = 0; k < laneCount; ++k) {
      const Eigen::VectorXd found = system.unpackedMany(x, k);
      if (b.col(k).isZero(0.0)) {
        EXPECT_TRUE(found.isZero(0.0)) << "a zero right-hand side stays zero, vector " << k;
      } else {
        EXPECT_LT((found - expected.col(k)).norm(), 2.0 * tolerance * b.col(k).norm()) << rows << " rows, vector " << k;
      }
    }
  }
}

TEST(ConjugateGradient, ZeroRightHandSide) {
  Random random(35);
  SerialExecutor executor;
  const System system(20, 40, random);
  ConjugateGradient cg;
  cg.prepare(system.matrix, system.values, system.diagonal, executor);
  const std::vector<float> b(system.matrix.vectorSize(), 0.0F);
  std::vector<float> x(b.size(), 7.0F);
  const SolveReport report = cg.solve(system.matrix, system.values, b, x, 1e-6, 100, executor);
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.iterations, 0U);
  EXPECT_EQ(report.residual, 0.0);
  EXPECT_EQ(x, b);
}

TEST(ConjugateGradient, ACapThatBindsIsReported) {
  Random random(36);
  SerialExecutor executor;
  const System system(140, 420, random);
  ConjugateGradient cg;
  cg.prepare(system.matrix, system.values, system.diagonal, executor);
  const Eigen::VectorXd b = randomVector(3 * 140, random);
  std::vector<float> x(system.matrix.vectorSize());
  const SolveReport one = cg.solve(system.matrix, system.values, system.packed(b), x, 1e-6, 2, executor);
  EXPECT_FALSE(one.converged);
  EXPECT_EQ(one.iterations, 2U);
  EXPECT_NEAR(one.residual, (b - system.dense * system.unpacked(x)).norm() / b.norm(), 1e-5);
  std::vector<float> many(x.size() * laneCount);
  Eigen::MatrixXd eight = Eigen::MatrixXd::Zero(3 * 140, laneCount);
  eight.col(5) = b;
  const SolveReport column =
      cg.solveMany(system.matrix, system.values, system.packedMany(eight), many, 1e-6, 2, executor);
  EXPECT_FALSE(column.converged);
  EXPECT_EQ(column.iterations, 2U);
  EXPECT_NEAR(column.residual, one.residual, 1e-5);
  EXPECT_LT((system.unpackedMany(many, 5) - system.unpacked(x)).norm(), 1e-5 * system.unpacked(x).norm());
}

/// Diagonal blocks are positive definite, the whole is not: [I 2I; 2I I] has the eigenvalue -1.
TEST(ConjugateGradient, AnIndefiniteMatrixIsNoSilentMiss) {
  const BlockMatrix matrix({{0, 1}, {0, 1}});
  std::vector<float> values(matrix.valueCount(), 0.0F);
  for (std::size_t r = 0; r < 2; ++r) {
    for (std::size_t k = 0; k < 2; ++k) {
      for (std::size_t i = 0; i < 3; ++i) values[matrix.slot(r, k) + 8 * 4 * i] = r == k ? 1.0F : 2.0F;
    }
  }
  SerialExecutor executor;
  ConjugateGradient cg;
  const std::vector<int> diagonal{0, 1};
  cg.prepare(matrix, values, diagonal, executor);
  std::vector<float> b(matrix.vectorSize(), 0.0F);
  b[laneOffset(0)] = 1.0F;
  b[laneOffset(1)] = -1.0F;
  std::vector<float> x(b.size());
  const SolveReport report = cg.solve(matrix, values, b, x, 1e-6, 100, executor);
  EXPECT_FALSE(report.converged);
  for (const float v : x) EXPECT_TRUE(std::isfinite(v));
}

}  // namespace
}  // namespace calot
