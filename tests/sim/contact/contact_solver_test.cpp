// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/contact_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/sim/contact/support/contact_reference.h"

namespace calot::contact_solver_test {
namespace {

using test::OwnedProblem;

/// Reports are held against what is there.
double residualOf(const OwnedProblem& problem, const std::vector<double>& lambda) {
  std::vector<double> gap(problem.rows());
  evaluateGaps(problem.view(), lambda, gap);
  return naturalResidual(problem.view(), lambda, gap);
}

TEST(ContactSolver, AgreesWithEnumerationOfActiveSets) {
  SCOPED_TRACE("seed 20");
  Random random(20);
  ContactSolver solver;
  for (int trial = 0; trial < 600; ++trial) {
    const int n = 1 + trial % 6;
    Eigen::VectorXd free(n);
    const Eigen::MatrixXd w = test::randomCompliance(random, n, 0.3);
    for (int i = 0; i < n; ++i) free[i] = random.normal();
    const OwnedProblem problem = test::unilateralRows(w, free);
    // Any warm start leads to the same place, by sweeps alone and with Newton steps; negative values count as zero.
    std::vector<double> lambda = problem.zeros();
    for (double& l : lambda) l = trial % 4 < 2 ? 0.0 : random.normal();
    std::vector<double> gap = problem.zeros();
    const bool sweeps = trial % 2 == 0;
    const ContactReport report = sweeps ? sweepContacts(problem.view(), lambda, gap, 1e-12, 100000)
                                        : solver.solve(problem.view(), lambda, gap, 1e-12, 3);
    ASSERT_TRUE(report.converged) << "trial " << trial << " residual " << report.residual;
    EXPECT_LE(report.residual, 1e-12);
    EXPECT_TRUE(!sweeps || report.newtonSteps == 0);
    const Eigen::VectorXd expected = test::byEnumeration(w, free);
    for (int i = 0; i < n; ++i) {
      ASSERT_NEAR(lambda[static_cast<std::size_t>(i)], expected[i], 1e-9) << "trial " << trial << " row " << i;
      ASSERT_GE(lambda[static_cast<std::size_t>(i)], 0.0);
      ASSERT_NEAR(gap[static_cast<std::size_t>(i)], (w * expected + free)[i], 1e-9);
    }
  }
}

TEST(ContactSolver, OneUnilateralRowInClosedForm) {
  for (const double free : {-3e-3, -1e-9, 0.0, 2e-3}) {
    const OwnedProblem problem =
        test::unilateralRows(Eigen::MatrixXd::Constant(1, 1, 2e-3), Eigen::VectorXd::Constant(1, free));
    std::vector<double> lambda{0.0};
    std::vector<double> gap{7.0};
    EXPECT_TRUE(sweepContacts(problem.view(), lambda, gap, 1e-15, 10).converged);
    EXPECT_DOUBLE_EQ(lambda[0], std::max(0.0, -free / 2e-3));
    EXPECT_NEAR(gap[0], std::max(0.0, free), 1e-18);
  }
}

TEST(ContactSolver, AForceMayOpenItsNeighboursGap) {
  Eigen::Matrix2d w;
  w << 2.0, 1.0, 1.0, 2.0;
  const OwnedProblem problem = test::unilateralRows(w, Eigen::Vector2d(-1.0, -0.1));
  std::vector<double> lambda{0.0, 5.0};
  std::vector<double> gap = problem.zeros();
  EXPECT_TRUE(sweepContacts(problem.view(), lambda, gap, 1e-14, 200).converged);
  EXPECT_NEAR(lambda[0], 0.5, 1e-13);
  EXPECT_EQ(lambda[1], 0.0);
}

/// The same place twice: W is singular, and only the sum of the two forces is determined.
TEST(ContactSolver, RedundantRowsShareTheForce) {
  const OwnedProblem problem = test::unilateralRows(Eigen::MatrixXd::Constant(2, 2, 2.0), Eigen::Vector2d(-1.0, -1.0));
  std::vector<double> lambda{0.0, 0.0};
  std::vector<double> gap = problem.zeros();
  EXPECT_TRUE(sweepContacts(problem.view(), lambda, gap, 1e-14, 200).converged);
  EXPECT_NEAR(lambda[0] + lambda[1], 0.5, 1e-13);
}

TEST(ContactSolver, NoRowsIsSolved) {
  ContactSolver solver;
  const ContactReport report = solver.solve({}, {}, {}, 0.0, 0);
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.sweeps, 0U);
  EXPECT_EQ(report.newtonSteps, 0U);
  EXPECT_EQ(report.residual, 0.0);
}

TEST(ContactSolver, ACapThatBindsIsReportedWithItsResidual) {
  // Strongly coupled rows: Gauss-Seidel gains a factor 0.81 a sweep.
  Eigen::Matrix2d w;
  w << 1.0, 0.9, 0.9, 1.0;
  const OwnedProblem problem = test::unilateralRows(w, Eigen::Vector2d(-1.0, -1.0));
  std::vector<double> lambda{-4.0, 0.0};
  std::vector<double> gap = problem.zeros();
  const ContactReport none = sweepContacts(problem.view(), lambda, gap, 1e-9, 0);
  EXPECT_FALSE(none.converged);
  EXPECT_EQ(none.sweeps, 0U);
  EXPECT_EQ(none.residual, 1.0) << "both gaps are -1 m without forces";
  EXPECT_EQ(lambda, (std::vector<double>{0.0, 0.0})) << "a negative warm start counts as zero";
  const ContactReport few = sweepContacts(problem.view(), lambda, gap, 1e-9, 5);
  EXPECT_FALSE(few.converged);
  EXPECT_EQ(few.sweeps, 5U);
  EXPECT_NEAR(few.residual, residualOf(problem, lambda), 1e-15);
  EXPECT_GT(few.residual, 1e-3);
  const ContactReport all = sweepContacts(problem.view(), lambda, gap, 1e-9, 1000);
  EXPECT_TRUE(all.converged);
  EXPECT_NEAR(lambda[0], 1.0 / 1.9, 1e-8);
}

/// One contact with W = diag(a, b, b): the normal force is -free_n / a; the disc holds the slip or it does not.
TEST(ContactSolver, OneFrictionalContactSticksOrSlips) {
  constexpr double a = 2e-3;
  constexpr double b = 3e-3;
  constexpr double mu = 0.4;
  const double normal = 1e-3 / a;
  const double most = mu * normal * b;  // slip that the disc can just hold (m)
  int stuck = 0;
  int slid = 0;
  for (int direction = 0; direction < 12; ++direction) {
    for (const double share : {0.0, 0.5, 0.999, 1.001, 3.0, 40.0}) {
      const double angle = 0.7 * direction;
      const Eigen::Vector2d slip = share * most * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      const OwnedProblem problem{{BlockKind::frictional},
                                 {mu},
                                 Eigen::Vector3d(a, b, b).asDiagonal().toDenseMatrix(),
                                 Eigen::Vector3d(-1e-3, slip[0], slip[1])};
      std::vector<double> lambda = problem.zeros();
      std::vector<double> gap = problem.zeros();
      const ContactReport report = sweepContacts(problem.view(), lambda, gap, 1e-15, 100);
      ASSERT_TRUE(report.converged) << report.residual;
      EXPECT_NEAR(lambda[0], normal, 1e-12);
      const Eigen::Vector2d expected =
          share <= 1.0 ? Eigen::Vector2d(-slip / b) : Eigen::Vector2d(-mu * normal * slip.normalized());
      EXPECT_LT((Eigen::Vector2d(lambda[1], lambda[2]) - expected).norm(), 1e-10) << share;
      const Eigen::Vector2d left = slip + b * expected;
      EXPECT_LT((Eigen::Vector2d(gap[1], gap[2]) - left).norm(), 1e-12);
      (share <= 1.0 ? stuck : slid) += 1;
      // A contact that is open holds nothing.
      OwnedProblem open = problem;
      open.free[0] = 1e-6;
      ASSERT_TRUE(sweepContacts(open.view(), lambda, gap, 1e-15, 100).converged);
      EXPECT_EQ(lambda, open.zeros());
      EXPECT_LT((Eigen::Vector2d(gap[1], gap[2]) - slip).norm(), 1e-18);
    }
  }
  EXPECT_GT(stuck, 10);
  EXPECT_GT(slid, 10);
}

/// Where normal and slip are coupled by c, a contact that slides along x by s = +-1 has lambda_n = -free_n / (a - c mu
/// s).
TEST(ContactSolver, SlidingCoupledToTheNormalInClosedForm) {
  constexpr double a = 2.0;
  constexpr double b = 3.0;
  constexpr double mu = 0.5;
  for (const double c : {-0.8, 0.3, 1.1}) {
    for (const double s : {-1.0, 1.0}) {
      Eigen::Matrix3d w = Eigen::Vector3d(a, b, b).asDiagonal();
      w(0, 1) = w(1, 0) = c;
      const OwnedProblem problem{{BlockKind::frictional}, {mu}, w, Eigen::Vector3d(-1.0, 20.0 * s, 0.0)};
      std::vector<double> lambda = problem.zeros();
      std::vector<double> gap = problem.zeros();
      ContactSolver solver;
      ASSERT_TRUE(solver.solve(problem.view(), lambda, gap, 1e-13, 500).converged);
      const double normal = 1.0 / (a - c * mu * s);
      EXPECT_NEAR(lambda[0], normal, 1e-11) << "c " << c << " s " << s;
      EXPECT_NEAR(lambda[1], -mu * normal * s, 1e-11);
      EXPECT_NEAR(lambda[2], 0.0, 1e-12);
    }
  }
}

/// Two contacts side by side: pulling on the first until it slides loads the second through c. One sticks, one slides.
TEST(ContactSolver, OneOfTwoContactsSlides) {
  constexpr double a = 2.0;
  constexpr double b = 3.0;
  constexpr double c = 1.0;  // tangential coupling along x
  constexpr double mu = 0.3;
  Eigen::MatrixXd w = Eigen::MatrixXd::Zero(6, 6);
  w.diagonal() << a, b, b, a, b, b;
  w(1, 4) = w(4, 1) = c;
  Eigen::VectorXd free(6);
  free << -2.0, 5.0, 0.0, -4.0, 1.0, 0.0;
  const OwnedProblem problem{{BlockKind::frictional, BlockKind::frictional}, {mu, mu}, w, free};
  std::vector<double> lambda = problem.zeros();
  std::vector<double> gap = problem.zeros();
  ASSERT_TRUE(sweepContacts(problem.view(), lambda, gap, 1e-14, 500).converged);
  const double first = -mu * 2.0 / a;            // slides against +x: 5 m is more than it can hold
  const double second = -(1.0 + c * first) / b;  // sticks: free slip and what the first one carries over
  ASSERT_LT(std::abs(second), mu * 4.0 / a);
  EXPECT_NEAR(lambda[1], first, 1e-12);
  EXPECT_NEAR(lambda[4], second, 1e-12);
  EXPECT_NEAR(gap[1], 5.0 + b * first + c * second, 1e-12);
  EXPECT_GT(gap[1], 0.0);
  EXPECT_NEAR(gap[4], 0.0, 1e-12);
  EXPECT_LT(test::brokenLaws(problem, lambda), 1e-12);
}

/// A ball holds in every direction, up to its limit; there the point is pulled through, straight against the force.
TEST(ContactSolver, ABallHoldsUpToItsLimit) {
  SCOPED_TRACE("seed 23");
  Random random(23);
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::MatrixXd w = test::randomCompliance(random, 3, 0.5);
    const Eigen::Vector3d free(random.normal(), random.normal(), random.normal());
    const Eigen::Vector3d exact = -w.ldlt().solve(free);
    const double limit = exact.norm() * random.uniform(0.2, 2.0);
    const OwnedProblem problem{{BlockKind::bilateral}, {limit}, w, free};
    std::vector<double> lambda = problem.zeros();
    std::vector<double> gap = problem.zeros();
    ASSERT_TRUE(sweepContacts(problem.view(), lambda, gap, 1e-11, 5000).converged) << trial;
    const Eigen::Vector3d force(lambda[0], lambda[1], lambda[2]);
    EXPECT_LE(force.norm(), limit * (1.0 + 1e-9));
    if (exact.norm() <= limit) {
      EXPECT_LT((force - exact).norm(), 1e-9);
      continue;
    }
    const Eigen::Vector3d slip(gap[0], gap[1], gap[2]);
    EXPECT_NEAR(force.norm(), limit, 1e-9 * limit);
    EXPECT_GT(slip.norm(), 0.0);
    EXPECT_LT((slip.normalized() + force.normalized()).norm(), 1e-5) << "slip is against the force";
  }
}

/// A solved problem is recognised: the warm start is the answer and no sweep is spent.
TEST(ContactSolver, WarmStartAtTheSolutionCostsNothing) {
  Eigen::Matrix2d w;
  w << 2.0, 1.0, 1.0, 2.0;
  const OwnedProblem problem = test::unilateralRows(w, Eigen::Vector2d(-3.0, -3.0));
  std::vector<double> lambda{1.0, 1.0};
  std::vector<double> gap = problem.zeros();
  ContactSolver solver;
  const ContactReport report = solver.solve(problem.view(), lambda, gap, 0.0, 100);
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.sweeps + report.newtonSteps, 0U);
  EXPECT_EQ(lambda, (std::vector<double>{1.0, 1.0}));
}

/// A compliance that is not positive semidefinite may drive sweeps and Newton steps away without bound. Then the forces
/// of the start stay.
TEST(ContactSolver, ForcesThatMakeItWorseAreNotTaken) {
  SCOPED_TRACE("seed 29");
  Random random(29);
  ContactSolver solver;
  int ledAway = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const int n = 2 + trial % 7;
    Eigen::MatrixXd w(n, n);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j <= i; ++j) w(i, j) = w(j, i) = random.normal();
      w(i, i) = 0.1 + random.uniform();  // positive, as it always is
    }
    Eigen::VectorXd free(n);
    for (int i = 0; i < n; ++i) free[i] = random.normal() - 0.5;
    const OwnedProblem problem = test::unilateralRows(w, free);
    std::vector<double> lambda = problem.zeros();
    for (double& l : lambda) l = random.uniform();
    const double start = residualOf(problem, lambda);
    std::vector<double> swept = lambda;
    std::vector<double> gap = problem.zeros();
    const ContactReport sweeps = sweepContacts(problem.view(), swept, gap, 1e-10, 75);
    ledAway += sweeps.residual <= 1e3 * start ? 0 : 1;
    const ContactReport report = solver.solve(problem.view(), lambda, gap, 1e-10, 75);
    ASSERT_LE(report.residual, 1e3 * start) << "trial " << trial;
    ASSERT_NEAR(report.residual, residualOf(problem, lambda), 1e-9 * (1.0 + start)) << "trial " << trial;
    ASSERT_EQ(report.converged, report.residual <= 1e-10) << "trial " << trial;
    for (const double l : lambda) ASSERT_GE(l, 0.0) << "trial " << trial;
  }
  EXPECT_GT(ledAway, 100);
}

TEST(ContactSolver, MakesForcesAdmissible) {
  std::vector<double> force{-1.0};
  projectOntoFrictionCone(BlockKind::unilateral, 0.0, force);
  EXPECT_EQ(force[0], 0.0);
  force = {2.0, 3.0, -4.0};
  projectOntoFrictionCone(BlockKind::frictional, 0.5, force);
  EXPECT_EQ(force[0], 2.0);
  EXPECT_NEAR(force[1], 0.6, 1e-15);
  EXPECT_NEAR(force[2], -0.8, 1e-15);
  force = {-2.0, 3.0, -4.0};
  projectOntoFrictionCone(BlockKind::frictional, 0.5, force);
  EXPECT_EQ(force, (std::vector<double>{0.0, 0.0, 0.0})) << "no normal force, no friction";
  force = {2.0, 0.3, -0.4};
  projectOntoFrictionCone(BlockKind::frictional, 0.5, force);
  EXPECT_EQ(force, (std::vector<double>{2.0, 0.3, -0.4}));
  force = {0.0, 6.0, -8.0};
  projectOntoFrictionCone(BlockKind::bilateral, 5.0, force);
  EXPECT_NEAR(force[1], 3.0, 1e-15);
  EXPECT_NEAR(force[2], -4.0, 1e-15);
}

}  // namespace
}  // namespace calot::contact_solver_test
