// SPDX-License-Identifier: GPL-3.0-or-later
// The system of what is left of a carved solid.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/math/random.h"
#include "sim/solid/solid.h"
#include "tests/accuracy/support/cube_box.h"

namespace calot::solid_system_test {
namespace {

using test::CubeBox;
using test::cubeBox;

const SolidModel::Material soft{lameConstants(5e3, 0.4), 1000.0, 0.1, 0.02};

SolidSolver::Settings exactly() {
  SolidSolver::Settings settings;
  settings.tolerance = 1e-6;
  settings.cap = 2000;
  return settings;
}

Vec3 anyVector(Random& random, double size) {
  const double x = random.normal();
  const double y = random.normal();
  const double z = random.normal();
  return size * Vec3(x, y, z);
}

/// A box of cubes, its first layer held, and how full each cube is.
struct Carved {
  CubeBox box = cubeBox(6, 5, 4, Vec3::Zero(), 0.01);
  std::vector<bool> fixed;
  std::vector<double> fill;

  Carved() : fixed(box.firstFace()), fill(box.cube.size(), 1.0) {}
  [[nodiscard]] SolidModel model() const { return {box.node, box.cube, box.edge, fixed, soft}; }
};

SolidState stirred(const SolidModel& model, Random& random) {
  SolidState state = restState(model);
  for (const int n : model.freeNodes()) {
    state.position[static_cast<std::size_t>(n)] += anyVector(random, 5e-4);
    state.velocity[static_cast<std::size_t>(n)] = anyVector(random, 0.05);
  }
  return state;
}

/// What is left of a carved solid moves as a solid does that is made of those cubes alone.
TEST(SolidSystem, WhatIsLeftMovesAsASolidOfItsOwn) {
  SCOPED_TRACE("seed 411");
  Random random(411);
  for (int trial = 0; trial < 10; ++trial) {
    Carved carved;
    CubeBox rest = carved.box;
    rest.cube.clear();
    for (std::size_t c = 0; c < carved.fill.size(); ++c) {
      // The held layer stays, so that all of the rest may hang on something; what comes loose is part of both.
      const bool stays = c % 6 == 0 || random.uniform() > 0.1 * trial;
      carved.fill[c] = stays ? 1.0 : 0.0;
      if (stays) rest.cube.push_back(carved.box.cube[c]);
    }
    std::vector<int> number(carved.box.node.size(), -1);
    std::vector<Vec3> node;
    std::vector<bool> fixed;
    for (Index8& cube : rest.cube) {
      for (int& n : cube) {
        const auto was = static_cast<std::size_t>(n);
        if (number[was] < 0) {
          number[was] = static_cast<int>(node.size());
          node.push_back(carved.box.node[was]);
          fixed.push_back(carved.fixed[was]);
        }
        n = number[was];
      }
    }
    const SolidModel whole = carved.model();
    const SolidModel own(node, rest.cube, carved.box.edge, fixed, soft);
    SolidState a = stirred(whole, random);
    SolidState b = restState(own);
    for (std::size_t n = 0; n < number.size(); ++n) {
      if (number[n] < 0) continue;
      b.position[static_cast<std::size_t>(number[n])] = a.position[n];
      b.velocity[static_cast<std::size_t>(number[n])] = a.velocity[n];
    }
    SerialExecutor executor;
    SolidSolver first;
    SolidSolver second;
    const Vec3 gravity(0.0, -9.81, 0.0);
    ASSERT_TRUE(first.solveUnconstrained(whole, a, gravity, {}, exactly(), executor, {{}, carved.fill, {}}).converged);
    ASSERT_TRUE(second.solveUnconstrained(own, b, gravity, {}, exactly(), executor).converged);
    std::size_t compared = 0;
    for (std::size_t n = 0; n < number.size(); ++n) {
      if (number[n] < 0) {
        EXPECT_EQ(first.freeVelocity()[n], a.velocity[n]) << "trial " << trial << ", node " << n << " is in no cube";
        continue;
      }
      const Vec3& same = second.freeVelocity()[static_cast<std::size_t>(number[n])];
      EXPECT_LT((first.freeVelocity()[n] - same).norm(), 1e-5) << "trial " << trial << ", node " << n;
      ++compared;
    }
    EXPECT_EQ(compared, own.nodes());
  }
}

/// Solvers of any past go on alike, bit for bit, while cubes turn, thin out and go.
TEST(SolidSystem, NoBitDependsOnWhatWasThereBefore) {
  SCOPED_TRACE("seed 412");
  Random random(412);
  Carved carved;
  const SolidModel model = carved.model();
  SolidState state = restState(model);
  SerialExecutor executor;
  SolidSolver old;
  const SolidSolver::Settings settings = exactly();
  double farthest = 0.0;
  for (int step = 0; step < 60; ++step) {
    if (step % 3 == 0) {
      const auto cube = static_cast<std::size_t>(random.uniform() * static_cast<double>(carved.fill.size()));
      carved.fill[cube] = std::max(0.0, carved.fill[cube] - random.uniform());
    }
    const Vec3 gravity(0.0, step % 20 < 10 ? -30.0 : 30.0, 10.0);
    SolidState again = state;
    SolidSolver fresh;
    const Surroundings around{{}, carved.fill, {}};
    old.solveUnconstrained(model, state, gravity, {}, settings, executor, around);
    fresh.solveUnconstrained(model, again, gravity, {}, settings, executor, around);
    ASSERT_EQ(old.freeVelocity(), fresh.freeVelocity()) << "step " << step;
    ASSERT_TRUE(old.advance(model, state, {}, settings.step));
    for (std::size_t n = 0; n < model.nodes(); ++n) {
      farthest = std::max(farthest, (state.position[n] - model.rest()[n]).norm());
    }
  }
  EXPECT_GT(farthest, 0.01);  // it was bent in earnest
}

}  // namespace
}  // namespace calot::solid_system_test
