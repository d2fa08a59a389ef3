// SPDX-License-Identifier: GPL-3.0-or-later
// Beams against closed solutions: small and large bending, torsion, space curves, vibration.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "tests/sim/vessel/support/beams.h"

namespace calot {
namespace {

/// w = P L^3 / 3EI; for one-point elements with linear fields the tip is low by 1 / (4 n^2) of that.
TEST(BeamStatics, SmallTipForceIsEulerBernoulli) {
  const double load = 1e-4;
  std::array<double, 2> error{};
  const std::array<std::size_t, 2> elements{20, 40};
  for (std::size_t i = 0; i < 2; ++i) {
    const BeamModel model({test::unitBeam(elements[i], true)});
    BeamState state = restState(model);
    std::vector<Vec3> force(model.nodes(), Vec3::Zero());
    force.back() = Vec3(0.0, load, 0.0);
    BeamLoads loads;
    loads.force = force;
    ASSERT_LT(test::settle(model, state, loads, 1.0, 2000, 1e-14), 1e-14);
    error[i] = state.position.back()[1] / (load / 3.0) - 1.0;
    std::printf("Euler-Bernoulli, %zu elements: relative error %.3e\n", elements[i], error[i]);
    const double n = static_cast<double>(elements[i]);
    EXPECT_NEAR(error[i], -0.25 / (n * n), 2e-5);
  }
  EXPECT_NEAR(std::log2(error[0] / error[1]), 2.0, 0.1);
}

/// An end moment 2 pi EI / L bends a straight beam into a closed circle.
TEST(BeamStatics, EndMomentRollsUpIntoACircle) {
  std::array<double, 2> gap{};
  const std::array<std::size_t, 2> elements{20, 40};
  for (std::size_t i = 0; i < 2; ++i) {
    const BeamModel model({test::unitBeam(elements[i], true)});
    BeamState state = restState(model);
    std::vector<Vec3> torque(model.nodes(), Vec3::Zero());
    torque.back() = Vec3(0.0, 0.0, 2.0 * std::numbers::pi);
    BeamLoads loads;
    loads.torque = torque;
    ASSERT_LT(test::settle(model, state, loads, 0.2, 20000, 1e-10), 1e-10);
    gap[i] = state.position.back().norm();
    // Half-way round it is a diameter away.
    const Vec3 across = state.position[elements[i] / 2];
    EXPECT_NEAR(across[1], 1.0 / std::numbers::pi, 0.015 / std::numbers::pi);
    std::printf("circle, %zu elements: ends %.2e of the length apart\n", elements[i], gap[i]);
  }
  EXPECT_LT(gap[1], 0.005);
  EXPECT_NEAR(std::log2(gap[0] / gap[1]), 2.0, 0.3);
}

/// Angle = T L / GJ, for any angle: here a turn and three quarters, in surroundings that hold the axis straight (free,
/// it would buckle sideways: Greenhill).
TEST(BeamStatics, TorsionOfAHollowTube) {
  BeamBranch branch = test::unitBeam(40, true, 40.0);
  branch.section.wall = 0.3 * branch.section.outerRadius;
  branch.material.young = 1.0 / branch.section.secondMoment();
  const double stiffness = 1.0 / 1.3;  // EI / (1 + nu)
  const BeamModel model({branch});
  BeamState state = restState(model);
  const double angle = 3.5 * std::numbers::pi;
  std::vector<Vec3> torque(model.nodes(), Vec3::Zero());
  BeamLoads loads;
  loads.torque = torque;
  std::vector<BeamAttachment> around;
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    around.push_back({static_cast<int>(n), 1e4, 0.0, model.rest()[n], Vec3::Zero()});
  }
  loads.attachments = around;
  for (int k = 1; k <= 100; ++k) {
    torque.back() = Vec3(angle * stiffness * std::min(1.0, k / 50.0), 0.0, 0.0);
    test::settle(model, state, loads, 0.1, 200, 1e-13);
  }
  ASSERT_LT(test::settle(model, state, loads, 0.1, 20000, 1e-13), 1e-13);
  double turned = 0.0;
  for (std::size_t n = 1; n < model.nodes(); ++n) {
    const Quat step = state.orientation[n] * state.orientation[n - 1].conjugate();
    turned += 2.0 * std::atan2(step.vec().dot(Vec3::UnitX()), step.w());
  }
  std::printf("torsion: %.5f of %.5f rad\n", turned, angle);
  EXPECT_NEAR(turned / angle, 1.0, 0.01);
  for (const Vec3& p : state.position) EXPECT_LT(std::hypot(p[1], p[2]), 1e-9);
}

/// A quarter of a right angle's arc, radius 100, loaded across its plane (Bathe and Bolourchi 1979, Int. J. Numer.
/// Meth. Engng 14:961: E = 1e7, nu = 0, unit square section, eight elements). Tip places at 600 as published there and
/// by Simo and Vu-Quoc 1986, Comput. Meth. Appl. Mech. Engng 58:79. Here a round section of the same EI = GJ.
TEST(BeamStatics, FortyFiveDegreeBend) {
  BeamBranch branch;
  const std::size_t elements = 40;
  for (std::size_t i = 0; i <= elements; ++i) {
    const double a = 0.25 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(elements);
    branch.node.emplace_back(100.0 * (1.0 - std::cos(a)), 100.0 * std::sin(a), 0.0);
  }
  const double r = std::pow(1.0 / (3.0 * std::numbers::pi), 0.25);
  branch.section = {r, r};
  branch.material.young = 1e7;
  branch.material.density = 0.02;
  branch.fixedStart = true;
  const BeamModel model({branch});
  BeamState state = restState(model);
  std::vector<Vec3> force(model.nodes(), Vec3::Zero());
  force.back() = Vec3(0.0, 0.0, 600.0);
  BeamLoads loads;
  loads.force = force;
  ASSERT_LT(test::settle(model, state, loads, 0.5, 40000, 1e-7), 1e-7);
  const Vec3 tip = state.position.back();
  std::printf("45-degree bend at 600: %.2f %.2f %.2f (published 15.79 47.23 53.37; 15.9 47.2 53.4)\n", tip[0], tip[1],
              tip[2]);
  const Vec3 published(15.79, 47.23, 53.37);
  EXPECT_LT((tip - published).norm(), 0.01 * (published - model.rest().back()).norm());
}

/// First bending frequency of a cantilever: 3.5160 sqrt(EI / (m L^4)). A short step, since implicit Euler damps.
TEST(BeamStatics, CantileverVibratesAtItsNaturalFrequency) {
  const BeamModel model({test::unitBeam(40, true)});
  BeamState state = restState(model);
  std::vector<Vec3> force(model.nodes(), Vec3::Zero());
  force.back() = Vec3(0.0, 1e-4, 0.0);
  BeamLoads loads;
  loads.force = force;
  ASSERT_LT(test::settle(model, state, loads, 1.0, 2000, 1e-14), 1e-14);
  BeamSolver solver;
  const double h = 1e-3;
  std::vector<double> crossing;
  double before = state.position.back()[1];
  for (int i = 1; i < 12000; ++i) {
    solver.solveUnconstrained(model, state, {}, h);
    solver.advance(model, state);
    const double now = state.position.back()[1];
    if ((now < 0.0) != (before < 0.0)) crossing.push_back(h * (i + before / (before - now)));
    before = now;
  }
  ASSERT_GE(crossing.size(), 11U);
  const double frequency =
      std::numbers::pi * static_cast<double>(crossing.size() - 1) / (crossing.back() - crossing.front());
  std::printf("natural frequency: %.4f (exact 3.5160)\n", frequency);
  EXPECT_NEAR(frequency, 3.51602, 0.005 * 3.51602);
}

}  // namespace
}  // namespace calot
