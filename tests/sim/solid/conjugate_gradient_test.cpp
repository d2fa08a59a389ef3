// SPDX-License-Identifier: GPL-3.0-or-later
// Conjugate gradients against dense algebra in double.
#include "sim/solid/conjugate_gradient.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <Eigen/Dense>
#include <limits>
#include <set>
#include <vector>

#include "sim/math/random.h"
#include "tests/sim/solid/support/block_system.h"

namespace calot {
namespace {

using test::randomSystem;
using test::sizes;
using test::System;

/// Springs along the edges of an n^3 grid, each a hundred times as stiff along itself, and a little mass.
System gridSystem(int n) {
  Eigen::MatrixXd blocks = 0.1 * Eigen::MatrixXd::Identity(3 * n * n * n, 3 * n * n * n);
  std::vector<std::set<int>> near(static_cast<std::size_t>(n * n * n));
  for (int i = 0; i < n * n * n; ++i) {
    const int at[3] = {i % n, i / n % n, i / (n * n)};
    const int step[3] = {1, n, n * n};
    for (int axis = 0; axis < 3; ++axis) {
      if (at[axis] + 1 == n) continue;
      const int j = i + step[axis];
      Eigen::Matrix3d k = 0.01 * Eigen::Matrix3d::Identity();
      k(axis, axis) = 1.0;
      blocks.block<3, 3>(3 * i, 3 * i) += k;
      blocks.block<3, 3>(3 * j, 3 * j) += k;
      blocks.block<3, 3>(3 * i, 3 * j) -= k;
      blocks.block<3, 3>(3 * j, 3 * i) -= k;
      near[static_cast<std::size_t>(i)].insert(j);
      near[static_cast<std::size_t>(j)].insert(i);
    }
  }
  return {blocks, near};
}

/// Iterations of conjugate gradients in double with the inverse of `preconditioner`, to a residual in its norm.
int iterationsWith(const Eigen::MatrixXd& a, const Eigen::MatrixXd& preconditioner, const Eigen::VectorXd& b,
                   double tolerance) {
  const Eigen::LLT<Eigen::MatrixXd> m(preconditioner);
  Eigen::VectorXd r = b;
  Eigen::VectorXd z = m.solve(r);
  Eigen::VectorXd p = z;
  double size = r.dot(z);
  const double goal = tolerance * tolerance * size;
  int iterations = 0;
  for (; size > goal; ++iterations) {
    const Eigen::VectorXd y = a * p;
    r -= size / p.dot(y) * y;
    z = m.solve(r);
    const double next = r.dot(z);
    p = z + next / size * p;
    size = next;
  }
  return iterations;
}

/// The residual is that of the definition, and bounds the error: |e|_A <= sqrt(largest of M against A) |r|_M^-1.
TEST(ConjugateGradient, AgreesWithDenseFactorisation) {
  SCOPED_TRACE("seed 33");
  Random random(33);
  ConjugateGradient cg;  // one for all sizes: what an earlier system left behind must not matter
  for (const int nodes : sizes) {
    const System system = randomSystem(nodes, 2 * nodes, random);
    const Eigen::VectorXd b = system.randomVector(random);
    std::vector<float> x(system.matrix.vectorSize(), 7.0F);
    cg.precompute(system.matrix, system.values);
    constexpr double tolerance = 3e-5;
    const SolveReport report = cg.solve(system.matrix, system.values, system.packed(b), x, {tolerance, 1000});
    EXPECT_TRUE(report.converged) << nodes << " nodes";
    EXPECT_LE(report.residual, tolerance);
    EXPECT_GT(report.iterations, 0U);
    const Eigen::MatrixXd a = system.whole();
    const Eigen::MatrixXd m = system.preconditioner();
    const Eigen::VectorXd found = system.unpacked(x);
    const Eigen::VectorXd r = b - a * found;
    const double size = std::sqrt(b.dot(m.ldlt().solve(b)));
    EXPECT_LT(std::sqrt(r.dot(m.ldlt().solve(r))), 2.0 * tolerance * size) << nodes << " nodes: residual by recursion";
    const Eigen::VectorXd e = found - a.ldlt().solve(b);
    const double worst = Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(m, a).eigenvalues().maxCoeff();
    EXPECT_LT(std::sqrt(e.dot(a * e)), 2.0 * std::sqrt(worst) * tolerance * size) << nodes << " nodes";
    for (int i = 0; i < system.size(); ++i) {
      if (system.isPadding(i)) {
        EXPECT_EQ(found[i], 0.0) << "padding";
      }
    }
  }
}

/// What is left to do counts by its energy: a small load is solved no farther than `least`, a smaller one not at all,
/// and the residual is told from what the tolerance is counted from.
TEST(ConjugateGradient, EndsWhereWhatIsLeftIsNotWorthAnIteration) {
  SCOPED_TRACE("seed 34");
  Random random(34);
  const System system = randomSystem(60, 120, random);
  const Eigen::VectorXd b = system.randomVector(random);
  const Eigen::MatrixXd m = system.preconditioner();
  const double size = std::sqrt(b.dot(m.ldlt().solve(b)));
  ConjugateGradient cg;
  cg.precompute(system.matrix, system.values);
  std::vector<float> x(system.matrix.vectorSize());
  std::uint32_t before = 1000;
  for (const double share : {0.0, 1e-4, 1e-2, 0.3}) {
    const SolveGoal goal{1e-5, 1000, share * size};
    const SolveReport report = cg.solve(system.matrix, system.values, system.packed(b), x, goal);
    EXPECT_TRUE(report.converged) << share;
    EXPECT_LE(report.residual, goal.tolerance) << share;
    EXPECT_LT(report.iterations, before) << share;
    before = report.iterations;
    const Eigen::VectorXd r = b - system.whole() * system.unpacked(x);
    const double left = std::sqrt(r.dot(m.ldlt().solve(r)));
    EXPECT_LE(left, 2.0 * std::max(1e-5, share) * size) << share;
    if (share > 0.0) {
      EXPECT_NEAR(report.residual, 1e-5 * left / (share * size), 0.1 * report.residual + 1e-7);
    }
  }
  EXPECT_GT(before, 0U);
  const SolveReport none = cg.solve(system.matrix, system.values, system.packed(b), x, {1e-5, 1000, 1.01 * size});
  EXPECT_TRUE(none.converged);
  EXPECT_EQ(none.iterations, 0U);
  EXPECT_EQ(system.unpacked(x).norm(), 0.0);
  // A cap that binds is a miss, however little is asked for.
  EXPECT_FALSE(cg.solve(system.matrix, system.values, system.packed(b), x, {1e-5, 1, 1e-4 * size}).converged);
}

/// A loose solve and one that goes on from it are together one of both loads to the second's tolerance.
TEST(ConjugateGradient, GoesOnFromWhatWasLeftOpen) {
  SCOPED_TRACE("seed 36");
  Random random(36);
  const System system = randomSystem(60, 120, random);
  const Eigen::VectorXd first = system.randomVector(random);
  const Eigen::VectorXd second = 0.1 * system.randomVector(random);
  const Eigen::MatrixXd m = system.preconditioner();
  const auto sizeOf = [&](const Eigen::VectorXd& v) { return std::sqrt(v.dot(m.ldlt().solve(v))); };
  ConjugateGradient cg;
  cg.precompute(system.matrix, system.values);
  std::vector<float> x(system.matrix.vectorSize());
  const auto solved = [&](const Eigen::VectorXd& b, double tolerance, bool goesOn) {
    SolveGoal goal{1e-9, 1000, tolerance * sizeOf(first)};
    goal.goesOn = goesOn;
    EXPECT_TRUE(cg.solve(system.matrix, system.values, system.packed(b), x, goal).converged);
    return system.unpacked(x);
  };
  const Eigen::VectorXd loose = solved(first, 0.1, false);
  const double open = sizeOf(first - system.whole() * loose);
  EXPECT_GT(open, 0.01 * sizeOf(first)) << "something is left to go on from";
  const Eigen::VectorXd whole = loose + solved(second, 1e-5, true);
  EXPECT_LT(sizeOf(first + second - system.whole() * whole), 3e-5 * sizeOf(first));
  const Eigen::VectorXd nothingMore = whole + solved(Eigen::VectorXd::Zero(second.size()), 1e-6, true);
  EXPECT_LT(sizeOf(first + second - system.whole() * nothingMore), 5e-6 * sizeOf(first)) << "without another load";
  const Eigen::VectorXd afresh = solved(second, 1e-6, false);
  EXPECT_LT(sizeOf(second - system.whole() * afresh), 5e-6 * sizeOf(first)) << "another solve starts from nothing";
}

TEST(ConjugateGradient, BlocksThatTheStructureHasNoPlaceFor) {
  SCOPED_TRACE("seed 37");
  Random random(37);
  const System system = randomSystem(40, 60, random);
  Eigen::MatrixXd a = system.whole();
  std::vector<ExtraBlock> extra;
  for (const auto& [i, j] : {std::pair(3, 31), std::pair(3, 17), std::pair(22, 9)}) {
    Eigen::Matrix<double, 3, 6> g;
    for (int k = 0; k < 18; ++k) g(k / 6, k % 6) = random.normal();
    const Eigen::Matrix<double, 6, 6> block = g.transpose() * g;
    const int at[2] = {system.row[static_cast<std::size_t>(i)], system.row[static_cast<std::size_t>(j)]};
    for (int p = 0; p < 2; ++p) {
      for (int q = 0; q < 2; ++q) {
        ExtraBlock& one = extra.emplace_back();
        one.row = static_cast<std::size_t>(at[p]);
        one.column = static_cast<std::size_t>(at[q]);
        for (int k = 0; k < 9; ++k) {
          one.value[static_cast<std::size_t>(k)] = static_cast<float>(block(3 * p + k / 3, 3 * q + k % 3));
          a(3 * at[p] + k / 3, 3 * at[q] + k % 3) += static_cast<double>(one.value[static_cast<std::size_t>(k)]);
        }
      }
    }
  }
  const Eigen::VectorXd b = system.randomVector(random);
  ConjugateGradient cg;
  cg.precompute(system.matrix, system.values, extra);
  std::vector<float> x(system.matrix.vectorSize());
  EXPECT_TRUE(cg.solve(system.matrix, system.values, system.packed(b), x, {1e-6, 1000}).converged);
  const Eigen::VectorXd wanted = a.ldlt().solve(b);
  EXPECT_LT((system.unpacked(x) - wanted).norm(), 2e-5 * wanted.norm());
  Eigen::MatrixXd two = Eigen::MatrixXd::Zero(system.size(), laneCount);
  two.col(0) = b;
  two.col(6) = -b;
  std::vector<float> many(x.size() * laneCount);
  EXPECT_TRUE(cg.solveMany(system.matrix, system.values, system.packedMany(two), many, 1e-6, 1000).converged);
  EXPECT_LT((system.unpackedMany(many, 0) - wanted).norm(), 2e-5 * wanted.norm());
  EXPECT_LT((system.unpackedMany(many, 6) + wanted).norm(), 2e-5 * wanted.norm());
}

/// As many iterations as the method takes in double, and less than half of those with the diagonal blocks alone.
TEST(ConjugateGradient, SweepsHalveTheIterations) {
  SCOPED_TRACE("seed 38");
  Random random(38);
  const System system = gridSystem(6);
  const Eigen::VectorXd b = system.randomVector(random);
  ConjugateGradient cg;
  cg.precompute(system.matrix, system.values);
  std::vector<float> x(system.matrix.vectorSize());
  const SolveReport report = cg.solve(system.matrix, system.values, system.packed(b), x, {1e-4, 1000});
  const int sweeps = iterationsWith(system.whole(), system.preconditioner(), b, 1e-4);
  const int diagonal = iterationsWith(system.whole(), system.blockDiagonal(), b, 1e-4);
  RecordProperty("iterations", static_cast<int>(report.iterations));
  RecordProperty("iterations_diagonal", diagonal);
  EXPECT_NEAR(static_cast<int>(report.iterations), sweeps, 1);
  EXPECT_LT(2 * sweeps, diagonal + 4) << diagonal;
}

/// Each of eight right-hand sides comes out as it would alone, to the bit.
TEST(ConjugateGradient, CompanyChangesNoBit) {
  SCOPED_TRACE("seed 39");
  Random random(39);
  const System system = gridSystem(6);
  Eigen::MatrixXd b(system.size(), laneCount);
  for (int k = 0; k < laneCount; ++k) b.col(k) = system.randomVector(random) * (k % 3 == 0 ? 1e-3 : 1.0);
  ConjugateGradient cg;
  cg.precompute(system.matrix, system.values);
  std::vector<float> together(system.matrix.vectorSize() * laneCount);
  EXPECT_TRUE(cg.solveMany(system.matrix, system.values, system.packedMany(b), together, 1e-4, 500).converged);
  for (int k = 0; k < laneCount; ++k) {
    Eigen::MatrixXd one = Eigen::MatrixXd::Zero(system.size(), laneCount);
    const int lane = (k + 3) % laneCount;
    one.col(lane) = b.col(k);
    std::vector<float> alone(together.size());
    EXPECT_TRUE(cg.solveMany(system.matrix, system.values, system.packedMany(one), alone, 1e-4, 500).converged);
    for (int i = 0; i < system.size(); ++i) {
      ASSERT_EQ(together[System::atMany(i, k)], alone[System::atMany(i, lane)]) << "vector " << k << ", entry " << i;
    }
  }
}

TEST(ConjugateGradient, EightRightHandSidesWithZerosAmongThem) {
  SCOPED_TRACE("seed 34");
  Random random(34);
  ConjugateGradient cg;
  for (const int nodes : sizes) {
    const System system = randomSystem(nodes, 2 * nodes, random);
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(system.size(), laneCount);
    for (const int k : {0, 1, 3, 6}) b.col(k) = system.randomVector(random) * (k == 3 ? 1e-6 : 1.0);
    std::vector<float> x(system.matrix.vectorSize() * laneCount, 7.0F);
    cg.precompute(system.matrix, system.values);
    constexpr double tolerance = 1e-5;
    const SolveReport report = cg.solveMany(system.matrix, system.values, system.packedMany(b), x, tolerance, 1000);
    EXPECT_TRUE(report.converged) << nodes << " nodes";
    EXPECT_LE(report.residual, tolerance);
    const Eigen::MatrixXd expected = system.whole().ldlt().solve(b);
    for (int k = 0; k < laneCount; ++k) {
      const Eigen::VectorXd found = system.unpackedMany(x, k);
      if (b.col(k).isZero(0.0)) {
        EXPECT_TRUE(found.isZero(0.0)) << "a zero right-hand side stays zero, vector " << k;
      } else {
        EXPECT_LT((found - expected.col(k)).norm(), 5.0 * tolerance * b.col(k).norm()) << nodes << " nodes, " << k;
      }
    }
  }
}

TEST(ConjugateGradient, ZeroRightHandSide) {
  Random random(35);
  const System system = randomSystem(20, 40, random);
  ConjugateGradient cg;
  cg.precompute(system.matrix, system.values);
  const std::vector<float> b(system.matrix.vectorSize(), 0.0F);
  std::vector<float> x(b.size(), 7.0F);
  const SolveReport report = cg.solve(system.matrix, system.values, b, x, {1e-6, 100});
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.iterations, 0U);
  EXPECT_EQ(report.residual, 0.0);
  EXPECT_EQ(x, b);
}

TEST(ConjugateGradient, ACapThatBindsIsReported) {
  Random random(36);
  const System system = randomSystem(140, 420, random);
  ConjugateGradient cg;
  cg.precompute(system.matrix, system.values);
  const Eigen::VectorXd b = system.randomVector(random);
  std::vector<float> x(system.matrix.vectorSize());
  const SolveReport one = cg.solve(system.matrix, system.values, system.packed(b), x, {1e-6, 2});
  EXPECT_FALSE(one.converged);
  EXPECT_EQ(one.iterations, 2U);
  const Eigen::LDLT<Eigen::MatrixXd> m(system.preconditioner());
  const Eigen::VectorXd r = b - system.dense * system.unpacked(x);
  EXPECT_NEAR(one.residual, std::sqrt(r.dot(m.solve(r)) / b.dot(m.solve(b))), 1e-5);
  std::vector<float> many(x.size() * laneCount);
  Eigen::MatrixXd eight = Eigen::MatrixXd::Zero(system.size(), laneCount);
  eight.col(5) = b;
  const SolveReport column = cg.solveMany(system.matrix, system.values, system.packedMany(eight), many, 1e-6, 2);
  EXPECT_FALSE(column.converged);
  EXPECT_EQ(column.iterations, 2U);
  EXPECT_NEAR(column.residual, one.residual, 1e-5);
  EXPECT_LT((system.unpackedMany(many, 5) - system.unpacked(x)).norm(), 1e-5 * system.unpacked(x).norm());
}

/// Diagonal blocks are positive definite, the whole is not: [I 2I; 2I I] has the eigenvalue -1.
TEST(ConjugateGradient, AnIndefiniteMatrixIsNoSilentMiss) {
  Eigen::MatrixXd blocks = Eigen::MatrixXd::Identity(6, 6);
  blocks.block<3, 3>(0, 3) = blocks.block<3, 3>(3, 0) = 2.0 * Eigen::Matrix3d::Identity();
  const System system(blocks, {{1}, {0}});
  ConjugateGradient cg;
  cg.precompute(system.matrix, system.values);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(system.size());
  b[3 * system.row[0]] = 1.0;
  b[3 * system.row[1]] = -1.0;
  std::vector<float> x(system.matrix.vectorSize());
  const SolveReport report = cg.solve(system.matrix, system.values, system.packed(b), x, {1e-6, 100});
  EXPECT_FALSE(report.converged);
  for (const float v : x) EXPECT_TRUE(std::isfinite(v));
}

TEST(ConjugateGradient, WhatIsNotFiniteIsAMissAndLeavesNoTrace) {
  SCOPED_TRACE("seed 40");
  Random random(40);
  const System system = randomSystem(30, 60, random);
  ConjugateGradient cg;
  cg.precompute(system.matrix, system.values);
  const std::vector<float> good = system.packed(system.randomVector(random));
  std::vector<float> before(good.size());
  cg.solve(system.matrix, system.values, good, before, {1e-4, 100});
  std::vector<float> bad = good;
  bad[laneOffset(static_cast<std::size_t>(system.row[4]))] = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> x(good.size());
  EXPECT_FALSE(cg.solve(system.matrix, system.values, bad, x, {1e-4, 100}).converged);
  std::vector<float> after(good.size());
  EXPECT_TRUE(cg.solve(system.matrix, system.values, good, after, {1e-4, 100}).converged);
  EXPECT_EQ(before, after);
}

}  // namespace
}  // namespace calot
