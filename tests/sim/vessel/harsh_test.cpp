// SPDX-License-Identifier: GPL-3.0-or-later
// Vessels treated badly at the simulation's own step: always finite, quiet again afterwards.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "sim/math/random.h"
#include "sim/vessel/beam_state.h"
#include "tests/sim/vessel/support/beams.h"

namespace calot::harsh_test {
namespace {

Vec3 vectorOf(Random& random, double size) {
  const double x = random.normal();
  const double y = random.normal();
  const double z = random.normal();
  return size * Vec3(x, y, z);
}

/// Forces up to hundreds of newtons on random nodes, stiff attachments that jump, cuts, clips, with and without
/// tearing.
TEST(HarshVessels, StayFiniteAndComeToRest) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed, 77);
    BeamBranch trunk = test::duct(40, true, seed % 2 == 0);
    BeamBranch twig = test::duct(30, false, false);
    for (Vec3& p : twig.node) p = trunk.node[20] + Vec3(p[2], p[0], p[1]);
    twig.join = 20;
    if (seed % 3 != 0) trunk.material.ultimateStrain = twig.material.ultimateStrain = 1e9;
    if (seed % 4 == 1) trunk.material.stiffnessDamping = trunk.material.massDamping = 0.0;
    const BeamModel model({trunk, twig});
    BeamState state = restState(model);
    BeamSolver solver;
    std::vector<Vec3> force(model.nodes(), Vec3::Zero());
    std::vector<BeamAttachment> attachments;
    int torn = 0;
    int limited = 0;
    double strain = 0.0;
    double speed = 0.0;
    for (int k = 0; k < 2000; ++k) {
      if (k % 15 == 0) {
        std::fill(force.begin(), force.end(), Vec3::Zero());
        attachments.clear();
        const double size = k % 45 == 0 ? 300.0 : 3.0;
        for (int i = 0; i < 3; ++i) force[random.next() % model.nodes()] = vectorOf(random, size);
        const int node = static_cast<int>(random.next() % model.nodes());
        const double stiffness = k % 2 == 0 ? 1e3 : 1e9;
        attachments.push_back({node, stiffness, 1.0,
                               model.rest()[static_cast<std::size_t>(node)] + vectorOf(random, 0.02),
                               vectorOf(random, 1.0)});
      }
      if (k > 1400) {
        std::fill(force.begin(), force.end(), Vec3::Zero());
        attachments.clear();
      }
      if (k == 400) setClip(model, state, {pointAt(model, 1, 0.01), 0.002, 0.01, 0.005, 0.0, 1.0}, 1.0);
      if (k == 700 || k == 900 || k == 901) {
        part(state, pointAt(model, random.next() % 2, random.uniform(0.0, 0.03)), Parting::cut);
      }
      BeamLoads loads;
      loads.force = force;
      loads.attachments = attachments;
      EXPECT_TRUE(solver.solveUnconstrained(model, state, loads, 0.01)) << k;
      const BeamReport report = solver.advance(model, state);
      ASSERT_TRUE(report.finite) << k;
      ASSERT_TRUE(test::isFinite(state)) << k;
      torn += report.torn >= 0 ? 1 : 0;
      limited += report.limited ? 1 : 0;
      strain = std::max(strain, report.maxStrain);
      speed = report.maxSpeed;
    }
    std::printf("seed %2d: torn %d, slowed down in %d steps, strain up to %.1f, last speed %.1e m/s\n",
                static_cast<int>(seed), torn, limited, strain, speed);
    // What is held comes to rest; a free piece with mass damping drifts to a stop.
    if (trunk.material.massDamping > 0.0) {
      EXPECT_LT(speed, 1e-3);
    }
  }
}

/// A cut off piece without any hold: it drifts, slows down and stays finite.
TEST(HarshVessels, ALoosePieceDriftsToAStop) {
  const BeamModel model({test::duct(40, true, true)});
  BeamState state = restState(model);
  ASSERT_TRUE(part(state, pointAt(model, 0, 0.010), Parting::cut));
  ASSERT_TRUE(part(state, pointAt(model, 0, 0.020), Parting::cut));
  EXPECT_FALSE(part(state, pointAt(model, 0, 0.020), Parting::cut));
  for (Vec3& v : state.velocity) v = Vec3(0.1, 0.2, -0.1);
  state.velocity.front().setZero();
  state.velocity.back().setZero();
  BeamSolver solver;
  BeamReport report;
  for (int k = 0; k < 1000; ++k) {
    solver.solveUnconstrained(model, state, {}, 0.01);
    report = solver.advance(model, state);
    ASSERT_TRUE(test::isFinite(state));
  }
  EXPECT_LT(report.maxSpeed, 1e-6);
  EXPECT_LT((state.position.front() - model.rest().front()).norm(), 1e-15);
  // With alpha = 5 / s a piece at 0.245 m/s goes 49 mm.
  EXPECT_NEAR(state.maxDisplacement, 0.049, 0.008);
}

}  // namespace
}  // namespace calot::harsh_test
