// SPDX-License-Identifier: GPL-3.0-or-later
// The contact solver on problems of all kinds and sizes, by random numbers; its sums bit for bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "sim/contact/contact_solver.h"
#include "tests/sim/contact/support/contact_reference.h"

namespace calot {
namespace {

using test::OwnedProblem;

/// Reports are held against what is there.
double residualOf(const OwnedProblem& problem, const std::vector<double>& lambda) {
  std::vector<double> gap(problem.rows());
  evaluateGaps(problem.view(), lambda, gap);
  return naturalResidual(problem.view(), lambda, gap);
}

/// Kinds mixed at random, strongly coupled, with random warm starts. Whatever is reported is true; nearly all converge.
TEST(ContactSolverRandom, RandomProblemsObeyTheLawsOfContact) {
  SCOPED_TRACE("seed 24");
  Random random(24);
  ContactSolver solver;
  int converged = 0;
  int newton = 0;
  constexpr int trials = 1000;
  for (int trial = 0; trial < trials; ++trial) {
    OwnedProblem problem;
    int n = 0;
    for (int b = 0; b < 1 + trial % 8; ++b) {
      const auto kind = static_cast<BlockKind>(random.next() % 3U);
      problem.kind.push_back(kind);
      problem.limit.push_back(kind == BlockKind::bilateral ? 3.0 * random.uniform()
                                                           : (random.uniform() < 0.1 ? 0.0 : random.uniform()));
      n += static_cast<int>(blockRows(kind));
    }
    problem.w = test::randomCompliance(random, n, random.uniform() < 0.5 ? 0.3 * n : 0.3);
    problem.free.resize(n);
    for (int i = 0; i < n; ++i) problem.free[i] = random.normal();
    std::vector<double> lambda = problem.zeros();
    if (trial % 2 == 1) {
      for (double& l : lambda) l = random.normal();
    }
    std::vector<double> gap = problem.zeros();
    const ContactReport report = solver.solve(problem.view(), lambda, gap, 1e-10, 100);
    ASSERT_NEAR(report.residual, residualOf(problem, lambda), 1e-12) << "trial " << trial;
    ASSERT_EQ(report.converged, report.residual <= 1e-10);
    newton += report.newtonSteps > 0 ? 1 : 0;
    if (!report.converged) continue;
    ++converged;
    EXPECT_LT(test::brokenLaws(problem, lambda), 1e-8) << "trial " << trial;
  }
  std::printf("%d of %d random problems converged, %d with Newton steps\n", converged, trials, newton);
  EXPECT_GE(converged, trials * 97 / 100);
  EXPECT_GT(newton, 10) << "too easy to tell anything of Newton steps";
}

/// Rows that nearly repeat each other, where sweeps crawl: a contact listed twice with a compliance that differs by
/// rounding. What counts is the residual; how the force is shared between them is not determined.
TEST(ContactSolverRandom, NearlyRepeatedRowsAreSolvedByNewtonSteps) {
  SCOPED_TRACE("seed 22");
  Random random(22);
  ContactSolver solver;
  int newton = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const int kinds = 1 + trial % 4;
    const int n = 3 * kinds;
    // Every kind of row three times, bent by about 1e-6.
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(n, kinds + 1 + n);
    Eigen::VectorXd free(n);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j <= kinds; ++j) rows(i, j) = i < kinds ? random.normal() : rows(i % kinds, j);
      rows(i, kinds + 1 + i) = 1e-3 * random.uniform();
      free[i] = (i < kinds ? random.normal() : free[i % kinds]) + 1e-7 * random.normal();
    }
    const OwnedProblem problem = test::unilateralRows(rows * rows.transpose(), free);
    std::vector<double> lambda = problem.zeros();
    std::vector<double> gap = problem.zeros();
    const ContactReport report = solver.solve(problem.view(), lambda, gap, 1e-9, 50);
    for (const double l : lambda) ASSERT_GE(l, 0.0);
    ASSERT_NEAR(report.residual, residualOf(problem, lambda), 1e-12);
    EXPECT_TRUE(report.converged) << "trial " << trial << " rows " << n << " residual " << report.residual;
    EXPECT_LT(test::brokenLaws(problem, lambda), 1e-8);
    newton += report.newtonSteps > 0 ? 1 : 0;
  }
  EXPECT_GT(newton, 50);
}

/// The size that the haptic loop is made for: thirty places of frictional contact on a soft body, where far places
/// hardly know of each other. W from a decaying kernel, as an elastic surface has.
TEST(ContactSolverRandom, ThirtyFrictionalContacts) {
  SCOPED_TRACE("seed 25");
  Random random(25);
  ContactSolver solver;
  std::uint32_t maxSweeps = 0;
  for (int trial = 0; trial < 30; ++trial) {
    constexpr int contacts = 30;
    std::vector<Eigen::Vector2d> place(contacts);
    for (Eigen::Vector2d& p : place) p = Eigen::Vector2d(0.03 * random.uniform(), 0.03 * random.uniform());
    OwnedProblem problem{std::vector<BlockKind>(contacts, BlockKind::frictional), std::vector<double>(contacts, 0.2),
                         Eigen::MatrixXd::Zero(3 * contacts, 3 * contacts), Eigen::VectorXd::Zero(3 * contacts)};
    for (int i = 0; i < contacts; ++i) {
      for (int j = 0; j < contacts; ++j) {
        const double distance = (place[static_cast<std::size_t>(i)] - place[static_cast<std::size_t>(j)]).norm();
        const double coupled = 2e-3 / (1.0 + distance * distance / (0.004 * 0.004));
        for (int k = 0; k < 3; ++k) problem.w(3 * i + k, 3 * j + k) = (k == 0 ? 1.0 : 0.7) * coupled;
      }
      problem.w.diagonal().segment(3 * i, 3).array() += 2e-4;
      problem.free[3 * i] = 1e-3 * random.normal() - 5e-4;
      problem.free[3 * i + 1] = 4e-4 * random.normal();
      problem.free[3 * i + 2] = 4e-4 * random.normal();
    }
    std::vector<double> lambda = problem.zeros();
    std::vector<double> gap = problem.zeros();
    const ContactReport report = solver.solve(problem.view(), lambda, gap, 1e-9, 200);
    EXPECT_TRUE(report.converged) << "trial " << trial << " residual " << report.residual;
    EXPECT_LT(test::brokenLaws(problem, lambda), 1e-8);
    maxSweeps = std::max(maxSweeps, report.sweeps);
    // The answer as warm start is recognised: no sweep, not a bit changed.
    std::vector<double> again = lambda;
    const ContactReport warm = solver.solve(problem.view(), again, gap, 1e-9, 200);
    EXPECT_TRUE(warm.converged);
    EXPECT_EQ(warm.sweeps + warm.newtonSteps, 0U);
  }
  std::printf("30 frictional contacts: at most %u sweeps\n", maxSweeps);
}

/// Columns are added in vectors of whatever width the machine has: element by element these are the bits of the plain
/// sum, for every size up to several vectors with all remainders.
TEST(ContactSolverRandom, GapsHaveTheBitsOfThePlainSum) {
  SCOPED_TRACE("seed 26");
  Random random(26);
  for (int n = 1; n <= 97; ++n) {
    const OwnedProblem problem = test::unilateralRows(test::randomCompliance(random, n, 0.1), [&] {
      Eigen::VectorXd free(n);
      for (int i = 0; i < n; ++i) free[i] = random.normal();
      return free;
    }());
    std::vector<double> lambda = problem.zeros();
    for (double& l : lambda) l = random.uniform() < 0.3 ? 0.0 : random.normal();
    std::vector<double> gap = problem.zeros();
    evaluateGaps(problem.view(), lambda, gap);
    for (int i = 0; i < n; ++i) {
      volatile double sum = problem.free[i];
      for (int j = 0; j < n; ++j) {
        const double l = lambda[static_cast<std::size_t>(j)];
        if (l == 0.0) continue;
        volatile const double product = l * problem.w(i, j);
        sum = sum + product;
      }
      ASSERT_EQ(std::bit_cast<std::uint64_t>(gap[static_cast<std::size_t>(i)]),
                std::bit_cast<std::uint64_t>(static_cast<double>(sum)))
          << "n " << n << " row " << i;
    }
  }
}

}  // namespace
}  // namespace calot
