// SPDX-License-Identifier: GPL-3.0-or-later
// Laws that a beam keeps whatever its shape: invariance, balance, exact answers to pushes, the same bits again.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "sim/math/fields.h"
#include "sim/math/random.h"
#include "sim/vessel/beam_model.h"
#include "sim/vessel/beam_state.h"
#include "tests/sim/vessel/support/beams.h"

namespace calot {
namespace {

Vec3 vectorOf(Random& random, double size) {
  const double x = random.normal();
  const double y = random.normal();
  const double z = random.normal();
  return size * Vec3(x, y, z);
}

Quat rotationOf(Random& random) {
  const double w = random.normal();
  const Vec3 v = vectorOf(random, 1.0);
  return normalised({w, v[0], v[1], v[2]});
}

/// exp(w) q.
Quat spun(const Quat& q, const Vec3& w) {
  const double angle = w.norm();
  return angle > 0.0 ? normalised(Quat(Eigen::AngleAxisd(angle, w / angle)) * q) : q;
}

/// A tree of three ducts that share one node.
BeamModel biliaryTree() {
  BeamBranch common = test::duct(12, true, false);
  BeamBranch hepatic = test::duct(12, false, true);
  BeamBranch cystic = test::duct(10, false, false);
  const Vec3 junction = common.node.back();
  for (Vec3& p : hepatic.node) p += junction;
  for (Vec3& p : cystic.node) p = junction + Vec3(0.3 * p[0], -p[1], p[0]);
  hepatic.join = cystic.join = static_cast<int>(common.node.size()) - 1;
  return BeamModel({common, hepatic, cystic});
}

/// A state far from rest, still of sound elements.
BeamState shaken(const BeamModel& model, Random& random, double speed) {
  BeamState state = restState(model);
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    if (model.fixed(n)) continue;
    state.position[n] += vectorOf(random, 2e-4);
    state.orientation[n] = spun(state.orientation[n], vectorOf(random, 0.3));
    state.velocity[n] = vectorOf(random, speed);
    state.angularVelocity[n] = vectorOf(random, 10.0 * speed);
  }
  return state;
}

double energyOf(const BeamElement& e, const BeamState& state) {
  const auto a = static_cast<std::size_t>(e.a);
  const auto b = static_cast<std::size_t>(e.b);
  const Mat3 middle = blend(state.orientation[a], state.orientation[b], 0.5).toRotationMatrix();
  const Vec3 gamma = middle.transpose() * (state.position[b] - state.position[a]) / e.length - e.slack;
  const Vec3 turn = middle.transpose() * quarterTangent(state.orientation[a], state.orientation[b]);
  const Vec3 kappa = 4.0 / e.length * (turn - e.bend);
  const double twist = kappa.dot(e.axis);
  return 0.5 * e.length *
         (e.stretching * gamma.squaredNorm() + e.bending * (kappa.squaredNorm() - twist * twist) +
          e.twisting * twist * twist);
}

TEST(Beam, ForcesAreTheGradientOfTheEnergy) {
  Random random(11);
  for (int sample = 0; sample < 50; ++sample) {
    const Vec3 axis = vectorOf(random, 1.0);
    BeamElement e;
    e.b = 1;
    e.length = 0.7;
    e.axis = axis / axis.norm();
    e.slack = e.axis + vectorOf(random, 0.2);  // loaded at rest
    e.bend = vectorOf(random, 0.1);
    e.stretching = 10.0;
    e.bending = 2.0;
    e.twisting = 1.3;
    BeamState state;
    state.position.assign(2, Vec3::Zero());
    state.orientation.assign(2, rotationOf(random));
    state.position[1] = vectorOf(random, 1.0);
    state.orientation[1] = spun(state.orientation[0], vectorOf(random, 0.5));
    state.sleeve.assign(1, 0.0);
    state.sleeveStretch.assign(1, Vec3::Zero());
    state.sleeveBend.assign(1, Vec3::Zero());
    const BeamStrain strain = strainOf(e, state, 0);
    const BeamStiffness k = stiffnessOf(e, strain, 0.0);
    const Vec3 analytic[4] = {strain.force, strain.moment - k.ga.transpose() * strain.force, -strain.force,
                              -strain.moment - k.gb.transpose() * strain.force};
    constexpr double h = 1e-6;
    for (int d = 0; d < 12; ++d) {
      const auto node = static_cast<std::size_t>(d / 6);
      const Vec3 move = h * Vec3::Unit(d % 3);
      BeamState up = state;
      BeamState down = state;
      if (d % 6 < 3) {
        up.position[node] += move;
        down.position[node] -= move;
      } else {
        up.orientation[node] = spun(state.orientation[node], move);
        down.orientation[node] = spun(state.orientation[node], -move);
      }
      const double slope = -(energyOf(e, up) - energyOf(e, down)) / (2.0 * h);
      ASSERT_NEAR(analytic[d / 3][d % 3], slope, 1e-6) << "direction " << d;
    }
  }
}

TEST(Beam, RigidMotionLeavesNoStrain) {
  const BeamModel model = biliaryTree();
  Random random(5);
  for (int sample = 0; sample < 20; ++sample) {
    const Quat turn = rotationOf(random);
    const Vec3 shift = vectorOf(random, 1.0);
    BeamState state = restState(model);
    for (std::size_t n = 0; n < model.nodes(); ++n) {
      state.position[n] = turn * state.position[n] + shift;
      state.orientation[n] = normalised(turn * state.orientation[n]);
    }
    for (std::size_t i = 0; i < model.elements().size(); ++i) {
      const BeamElement& e = model.elements()[i];
      const BeamStrain s = strainOf(e, state, i);
      EXPECT_LT(std::abs(s.stretch), 1e-11);
      EXPECT_LT(s.force.norm(), 1e-11 * e.stretching);
      EXPECT_LT(s.moment.norm(), 1e-11 * e.bending / e.length);
    }
  }
}

/// The same motion in a turned world is the turned motion.
TEST(Beam, MotionDoesNotDependOnTheFrame) {
  const BeamModel model({test::duct(20, false, false)});
  Random random(6);
  const Quat turn = rotationOf(random);
  BeamState one = shaken(model, random, 0.05);
  BeamState two = one;
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    two.position[n] = turn * one.position[n];
    two.orientation[n] = normalised(turn * one.orientation[n]);
    two.velocity[n] = turn * one.velocity[n];
    two.angularVelocity[n] = turn * one.angularVelocity[n];
  }
  BeamSolver solver;
  for (int k = 0; k < 50; ++k) {
    BeamLoads loads;
    loads.gravity = Vec3(0.0, 0.0, -9.81);
    solver.solveUnconstrained(model, one, loads, 0.005);
    solver.advance(model, one);
    loads.gravity = turn * loads.gravity;
    solver.solveUnconstrained(model, two, loads, 0.005);
    solver.advance(model, two);
  }
  for (std::size_t n = 0; n < model.nodes(); ++n) EXPECT_LT((two.position[n] - turn * one.position[n]).norm(), 1e-9);
}

/// Linear momentum to rounding; angular momentum as implicit Euler has it: lost, the less the shorter the step.
TEST(Beam, AFreeBeamKeepsItsMomentum) {
  BeamBranch branch = test::duct(40, false, false);
  branch.material.massDamping = 0.0;
  const BeamModel model({branch});
  std::array<double, 2> lost{};
  for (std::size_t i = 0; i < 2; ++i) {
    BeamState state = restState(model);
    for (std::size_t n = 0; n < model.nodes(); ++n) {
      const Vec3 spin(3.0, -2.0, 5.0);
      state.velocity[n] = Vec3(0.3, -0.2, 0.1) + spin.cross(state.position[n]);
      state.angularVelocity[n] = spin;
    }
    const auto momenta = [&] {
      std::array<Vec3, 2> sum{Vec3::Zero(), Vec3::Zero()};
      Vec3 middle = Vec3::Zero();
      double mass = 0.0;
      for (std::size_t n = 0; n < model.nodes(); ++n) {
        middle += model.mass()[n] * state.position[n];
        mass += model.mass()[n];
        sum[0] += model.mass()[n] * state.velocity[n];
      }
      middle /= mass;
      for (std::size_t n = 0; n < model.nodes(); ++n) {
        sum[1] += model.mass()[n] * (state.position[n] - middle).cross(state.velocity[n]) +
                  model.inertia()[n] * state.angularVelocity[n];
      }
      return sum;
    };
    const std::array<Vec3, 2> before = momenta();
    const double step = i == 0 ? 0.0005 : 0.00025;
    BeamSolver solver;
    for (double t = 0.0; t < 1.0; t += step) {
      solver.solveUnconstrained(model, state, {}, step);
      ASSERT_FALSE(solver.advance(model, state).limited);
    }
    const std::array<Vec3, 2> after = momenta();
    EXPECT_LT((after[0] - before[0]).norm(), 1e-9 * before[0].norm());
    lost[i] = (after[1] - before[1]).norm() / before[1].norm();
    std::printf("step %.2f ms, 1 s: momentum off by %.1e, angular momentum by %.1e of itself\n", 1e3 * step,
                (after[0] - before[0]).norm() / before[0].norm(), lost[i]);
  }
  EXPECT_LT(lost[0], 0.1);
  EXPECT_LT(lost[1], 0.6 * lost[0]);
}

TEST(Beam, ComplianceIsTheAnswerToAPush) {
  const BeamModel model = biliaryTree();
  Random random(8);
  BeamState state = shaken(model, random, 0.05);
  part(state, pointAt(model, 2, 0.01), Parting::cut);
  setClip(model, state, {pointAt(model, 1, 0.01), 0.002, 0.01, 0.005, 0.0, 1.0}, 1.0);
  BeamSolver solver;
  ASSERT_TRUE(solver.solveUnconstrained(model, state, {}, 0.01));
  const std::vector<int> nodes{5, 12, 20, 30, 0};
  solver.precomputeCompliance(model, nodes);
  for (const int b : nodes) {
    for (int k = 0; k < 3; ++k) {
      const std::vector<Vec3> before = solver.freeVelocity();
      std::vector<Vec3> impulse(model.nodes(), Vec3::Zero());
      impulse[static_cast<std::size_t>(b)] = 1e-3 * Vec3::Unit(k);
      solver.applyImpulses(model, impulse);
      for (std::size_t a = 0; a < model.nodes(); ++a) {
        const Vec3 expected = solver.block(static_cast<int>(a), b).col(k);
        const Vec3 found = (solver.freeVelocity()[a] - before[a]) / 1e-3;
        ASSERT_LT((found - expected).norm(), 1e-9 * (1.0 + expected.norm())) << a << " " << b;
      }
    }
  }
  for (const int a : nodes) {
    for (const int b : nodes) {
      EXPECT_LT((solver.block(a, b) - solver.block(b, a).transpose()).norm(), 1e-9 * (1.0 + solver.block(a, b).norm()));
    }
  }
  // Held nodes do not answer; nor does what lies beyond a cut.
  EXPECT_TRUE(solver.block(0, 5).isZero(0.0));
  EXPECT_TRUE(solver.block(static_cast<int>(model.nodes()) - 1, 5).isZero(0.0));
}

/// An impulse is the force of a step: pushing equals having had the force from the start.
TEST(Beam, APushEqualsAForceOverTheStep) {
  const BeamModel model({test::duct(40, true, true)});
  Random random(9);
  const BeamState state = shaken(model, random, 0.05);
  std::vector<Vec3> force(model.nodes(), Vec3::Zero());
  force[17] = Vec3(0.1, -0.2, 0.05);
  BeamLoads loads;
  loads.force = force;
  BeamSolver one;
  BeamSolver two;
  one.solveUnconstrained(model, state, loads, 0.01);
  two.solveUnconstrained(model, state, {}, 0.01);
  for (Vec3& f : force) f *= 0.01;
  two.applyImpulses(model, force);
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    EXPECT_LT((one.freeVelocity()[n] - two.freeVelocity()[n]).norm(), 1e-10);
  }
}

TEST(Beam, AttachmentsOfAnyStiffnessHold) {
  for (const double stiffness : {10.0, 1e4, 1e8, 1e12}) {
    const BeamModel model({test::duct(40, true, false)});
    BeamState state = restState(model);
    BeamSolver solver;
    std::vector<BeamAttachment> attachments{{40, stiffness, 0.01, model.rest().back(), Vec3::Zero()}};
    const Vec3 speed(0.02, 0.0, 0.01);
    BeamLoads loads;
    for (int k = 0; k < 2000; ++k) {
      attachments[0].velocity = k < 20 ? speed : Vec3::Zero();
      loads.attachments = attachments;
      ASSERT_TRUE(solver.solveUnconstrained(model, state, loads, 0.01));
      const BeamReport report = solver.advance(model, state);
      ASSERT_TRUE(report.finite);
      ASSERT_EQ(report.torn, -1);
      attachments[0].target += 0.01 * attachments[0].velocity;
    }
    ASSERT_TRUE(test::isFinite(state));
    // At rest the spring's force is what the last element pulls with.
    const BeamStrain last = strainOf(model.elements().back(), state, 39);
    const Vec3 reaction = stiffness * (state.position[40] - attachments[0].target);
    EXPECT_LT((reaction + last.force).norm(), 1e-6 * last.force.norm() + 1e-16 * stiffness + 1e-9) << stiffness;
    if (stiffness >= 1e4) {
      EXPECT_LT((state.position[40] - attachments[0].target).norm(), 1e-4) << stiffness;
    }
  }
}

TEST(Beam, ARestoredStateGoesOnWithTheSameBits) {
  const BeamModel model = biliaryTree();
  Random random(10);
  BeamState state = shaken(model, random, 0.1);
  setClip(model, state, {pointAt(model, 0, 0.02), 0.002, 0.01, 0.005, 0.3, 1.0}, 1.0);
  BeamSolver solver;
  BeamLoads loads;
  loads.gravity = Vec3(0.0, -2.0, 1.0);
  for (int k = 0; k < 50; ++k) {
    if (k == 30) part(state, pointAt(model, 2, 0.012), Parting::cut);
    solver.solveUnconstrained(model, state, loads, 0.01);
    solver.advance(model, state);
  }
  std::vector<std::byte> bytes;
  ByteWriter(bytes).write(state);
  BeamState restored;
  ByteReader reader(bytes);
  reader.read(restored);
  ASSERT_TRUE(reader.complete());
  ASSERT_TRUE(fits(model, restored));
  BeamSolver other;
  for (int k = 0; k < 50; ++k) {
    solver.solveUnconstrained(model, state, loads, 0.01);
    solver.advance(model, state);
    other.solveUnconstrained(model, restored, loads, 0.01);
    other.advance(model, restored);
  }
  std::vector<std::byte> one;
  std::vector<std::byte> two;
  ByteWriter(one).write(state);
  ByteWriter(two).write(restored);
  EXPECT_EQ(one, two);
}

TEST(Beam, FaultsOfADescriptionAreNamed) {
  const BeamBranch good = test::duct(10, true, true);
  EXPECT_EQ(BeamModel::faultOf({good}), "");
  EXPECT_NE(BeamModel::faultOf({}), "");
  BeamBranch bad = good;
  bad.material.poisson = 0.5;
  EXPECT_NE(BeamModel::faultOf({good, bad}).find("branch 1: Poisson"), std::string::npos);
  bad = good;
  bad.material.young = -1.0;
  EXPECT_NE(BeamModel::faultOf({bad}), "");
  bad = good;
  bad.node[3] = bad.node[2];
  EXPECT_NE(BeamModel::faultOf({bad}).find("coincide"), std::string::npos);
  bad = good;
  bad.node.resize(1);
  EXPECT_NE(BeamModel::faultOf({bad}), "");
  bad = good;
  bad.join = 11;
  EXPECT_NE(BeamModel::faultOf({good, bad}), "");
  bad = good;
  bad.section.wall = 0.0;
  EXPECT_NE(BeamModel::faultOf({bad}), "");
}

TEST(Beam, AStateOfAnotherModelDoesNotFit) {
  const BeamModel model({test::duct(10, true, true)});
  const BeamModel other({test::duct(11, true, true)});
  BeamState state = restState(model);
  EXPECT_TRUE(fits(model, state));
  EXPECT_FALSE(fits(other, state));
  state.orientation[3].w() += 0.1;
  EXPECT_FALSE(fits(model, state));
  state = restState(model);
  state.parting[2] = static_cast<Parting>(7);
  EXPECT_FALSE(fits(model, state));
  state = restState(model);
  state.clipPlace.push_back(0.01);
  EXPECT_FALSE(fits(model, state));
}

}  // namespace
}  // namespace calot
