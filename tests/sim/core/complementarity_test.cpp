// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/complementarity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <Eigen/Dense>
#include <vector>

#include "sim/math/random.h"

namespace calot {
namespace {

/// Tries every set of active rows; for a symmetric positive definite W exactly one fits.
Eigen::VectorXd byEnumeration(const Eigen::MatrixXd& w, const Eigen::VectorXd& free) {
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
    bool fits = lambda.minCoeff() >= -1e-12;
    for (int i = 0; i < n; ++i) {
      if ((set >> static_cast<unsigned>(i) & 1U) == 0) fits = fits && gap[i] >= -1e-12;
    }
    if (fits) return lambda;
  }
  ADD_FAILURE() << "no set of active rows fits";
  return Eigen::VectorXd::Zero(n);
}

TEST(Complementarity, AgreesWithEnumerationOfActiveSets) {
  constexpr std::uint64_t seed = 20;
  SCOPED_TRACE("seed 20");
  Random random(seed);
  for (int trial = 0; trial < 600; ++trial) {
    const int n = 1 + trial % 6;
    Eigen::MatrixXd a(n, n);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) a(i, j) = random.normal();
    }
    const Eigen::MatrixXd w = a * a.transpose() + 0.3 * Eigen::MatrixXd::Identity(n, n);
    Eigen::VectorXd free(n);
    std::vector<double> lambda(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) free[i] = random.normal();
    // Any warm start leads to the same place, by sweeps alone and by a search of the active set; negative values count
    // as zero.
    for (double& l : lambda) l = trial % 4 < 2 ? 0.0 : random.normal();
    const std::vector<double> flat(w.data(), w.data() + n * n);  // symmetric: the order does not matter
    const bool sweeps = trial % 2 == 0;
    const ComplementarityReport report =
        solveComplementarity(flat, {free.data(), static_cast<std::size_t>(n)}, lambda, 1e-12, sweeps ? 100000 : 1,
                             sweeps ? Finish::sweeps : Finish::pivoting);
    ASSERT_TRUE(report.converged) << "trial " << trial;
    EXPECT_LE(report.residual, 1e-12);
    EXPECT_TRUE(!sweeps || report.pivots == 0);
    const Eigen::VectorXd expected = byEnumeration(w, free);
    for (int i = 0; i < n; ++i) {
      ASSERT_NEAR(lambda[static_cast<std::size_t>(i)], expected[i], 1e-9) << "trial " << trial << " row " << i;
      ASSERT_GE(lambda[static_cast<std::size_t>(i)], 0.0);
    }
  }
}

TEST(Complementarity, OneRowInClosedForm) {
  for (const double free : {-3e-3, -1e-9, 0.0, 2e-3}) {
    const std::vector<double> w{2e-3};
    std::vector<double> lambda{0.0};
    const std::vector<double> gap{free};
    EXPECT_TRUE(solveComplementarity(w, gap, lambda, 1e-15, 10).converged);
    EXPECT_DOUBLE_EQ(lambda[0], std::max(0.0, -free / 2e-3));
  }
}

TEST(Complementarity, AForceMayOpenItsNeighboursGap) {
  const std::vector<double> w{2.0, 1.0, 1.0, 2.0};
  const std::vector<double> free{-1.0, -0.1};
  std::vector<double> lambda{0.0, 5.0};
  EXPECT_TRUE(solveComplementarity(w, free, lambda, 1e-14, 200).converged);
  EXPECT_NEAR(lambda[0], 0.5, 1e-13);
  EXPECT_EQ(lambda[1], 0.0);
}

/// The same place twice: W is singular, and only the sum of the two forces is determined.
TEST(Complementarity, RedundantRowsShareTheForce) {
  const std::vector<double> w{2.0, 2.0, 2.0, 2.0};
  const std::vector<double> free{-1.0, -1.0};
  std::vector<double> lambda{0.0, 0.0};
  EXPECT_TRUE(solveComplementarity(w, free, lambda, 1e-14, 200).converged);
  EXPECT_NEAR(lambda[0] + lambda[1], 0.5, 1e-13);
}

TEST(Complementarity, NoRowsIsSolved) {
  const ComplementarityReport report = solveComplementarity({}, {}, {}, 0.0, 0);
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.sweeps, 0U);
  EXPECT_EQ(report.residual, 0.0);
}

TEST(Complementarity, ACapThatBindsIsReportedWithItsResidual) {
  // Strongly coupled rows: Gauss-Seidel gains a factor 0.81 a sweep.
  const std::vector<double> w{1.0, 0.9, 0.9, 1.0};
  const std::vector<double> free{-1.0, -1.0};
  std::vector<double> lambda{-4.0, 0.0};
  const ComplementarityReport none = solveComplementarity(w, free, lambda, 1e-9, 0, Finish::sweeps);
  EXPECT_FALSE(none.converged);
  EXPECT_EQ(none.sweeps, 0U);
  EXPECT_EQ(none.residual, 1.0) << "both gaps are -1 m without forces";
  EXPECT_EQ(lambda, (std::vector<double>{0.0, 0.0})) << "a negative warm start counts as zero";
  const ComplementarityReport few = solveComplementarity(w, free, lambda, 1e-9, 5, Finish::sweeps);
  EXPECT_FALSE(few.converged);
  EXPECT_EQ(few.sweeps, 5U);
  const double gap = free[0] + w[0] * lambda[0] + w[1] * lambda[1];
  EXPECT_NEAR(few.residual, std::abs(std::min(lambda[0], gap)), 1e-15);
  const ComplementarityReport all = solveComplementarity(w, free, lambda, 1e-9, 1000, Finish::sweeps);
  EXPECT_TRUE(all.converged);
  EXPECT_NEAR(lambda[0], 1.0 / 1.9, 1e-8);
}

/// Rows that nearly repeat each other, where sweeps crawl: a contact listed twice with a compliance that differs by
/// rounding. What counts is the residual; how the force is shared between them is not determined.
TEST(Complementarity, NearlyRepeatedRowsAreSolvedByPivoting) {
  SCOPED_TRACE("seed 22");
  Random random(22);
  for (int trial = 0; trial < 200; ++trial) {
    const int kinds = 1 + trial % 4;
    Eigen::MatrixXd a(kinds, kinds + 1);
    for (int i = 0; i < kinds; ++i) {
      for (int j = 0; j <= kinds; ++j) a(i, j) = random.normal();
    }
    // Every kind of row twice or three times, bent by about 1e-6.
    const int n = 3 * kinds;
    Eigen::MatrixXd rows(n, kinds + 1 + n);
    rows.setZero();
    std::vector<double> free(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) {
      rows.block(i, 0, 1, kinds + 1) = a.row(i % kinds);
      rows(i, kinds + 1 + i) = 1e-3 * random.uniform();
      free[static_cast<std::size_t>(i)] =
          (i < kinds ? random.normal() : free[static_cast<std::size_t>(i % kinds)]) + 1e-7 * random.normal();
    }
    const Eigen::MatrixXd w = rows * rows.transpose();
    const std::vector<double> flat(w.data(), w.data() + n * n);
    std::vector<double> lambda(free.size(), 0.0);
    const ComplementarityReport report = solveComplementarity(flat, free, lambda, 1e-9, 50);
    double residual = 0.0;
    for (int i = 0; i < n; ++i) {
      double gap = free[static_cast<std::size_t>(i)];
      for (int j = 0; j < n; ++j) gap += w(i, j) * lambda[static_cast<std::size_t>(j)];
      ASSERT_GE(lambda[static_cast<std::size_t>(i)], 0.0);
      residual = std::max(residual, std::abs(std::min(w(i, i) * lambda[static_cast<std::size_t>(i)], gap)));
    }
    ASSERT_NEAR(residual, report.residual, 1e-12) << "the residual that is reported is the one that is there";
    EXPECT_TRUE(report.converged) << "trial " << trial << " rows " << n << " residual " << report.residual;
  }
}

/// A solved problem is recognised: the warm start is the answer and no sweep is spent.
TEST(Complementarity, WarmStartAtTheSolutionCostsNothing) {
  const std::vector<double> w{2.0, 1.0, 1.0, 2.0};
  const std::vector<double> free{-3.0, -3.0};
  std::vector<double> lambda{1.0, 1.0};
  const ComplementarityReport report = solveComplementarity(w, free, lambda, 0.0, 100);
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.sweeps, 0U);
  EXPECT_EQ(lambda, (std::vector<double>{1.0, 1.0}));
}

}  // namespace
}  // namespace calot
