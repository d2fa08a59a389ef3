// SPDX-License-Identifier: GPL-3.0-or-later
// The matrix that is kept from step to step, and the system of what is left of a carved solid.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/math/random.h"
#include "sim/solid/solid.h"
#include "tests/accuracy/support/cube_box.h"

namespace calot {
namespace {

using test::CubeBox;
using test::cubeBox;

const SolidModel::Material soft{lameConstants(5e3, 0.4), 1000.0, 0.1, 0.02};

SolidSolver::Settings settingsWith(double grain) {
  SolidSolver::Settings settings;
  settings.tolerance = 1e-6;
  settings.cap = 2000;
  settings.grain = grain;
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

  Carved() : fixed(box.node.size(), false), fill(box.cube.size(), 1.0) {
    for (int k = 0; k <= box.nz; ++k) {
      for (int j = 0; j <= box.ny; ++j) fixed[static_cast<std::size_t>(box.index(0, j, k))] = true;
    }
  }
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
    ASSERT_TRUE(first.freeMotion(whole, a, gravity, {}, settingsWith(0.0), executor, {{}, carved.fill, {}}).converged);
    ASSERT_TRUE(second.freeMotion(own, b, gravity, {}, settingsWith(0.0), executor).converged);
    std::size_t compared = 0;
    for (std::size_t n = 0; n < number.size(); ++n) {
      if (number[n] < 0) {
        EXPECT_EQ(first.freeVelocity()[n], a.velocity[n]) << "trial " << trial << ", node " << n << " is in no cube";
        continue;
      }
      const Vec3& same = second.freeVelocity()[static_cast<std::size_t>(number[n])];
      EXPECT_LT((first.freeVelocity()[n] - same).norm(), 2e-6) << "trial " << trial << ", node " << n;
      ++compared;
    }
    EXPECT_EQ(compared, own.nodes());
  }
}

/// Kept blocks are those that would be made: solvers of any past go on alike, bit for bit, while cubes turn, thin out
/// and go.
TEST(StiffnessAssembly, NoBitDependsOnWhatWasKept) {
  SCOPED_TRACE("seed 412");
  Random random(412);
  Carved carved;
  const SolidModel model = carved.model();
  SolidState state = restState(model);
  SerialExecutor executor;
  SolidSolver old;
  const SolidSolver::Settings settings = settingsWith(1.0 / 32.0);
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
    old.freeMotion(model, state, gravity, {}, settings, executor, around);
    fresh.freeMotion(model, again, gravity, {}, settings, executor, around);
    ASSERT_EQ(old.freeVelocity(), fresh.freeVelocity()) << "step " << step;
    ASSERT_TRUE(old.advance(model, state, {}, settings.step));
    for (std::size_t n = 0; n < model.nodes(); ++n) {
      farthest = std::max(farthest, (state.position[n] - model.rest()[n]).norm());
    }
  }
  EXPECT_GT(farthest, 0.01);  // it was bent in earnest
}

/// Of tetrahedra as well.
TEST(StiffnessAssembly, NoBitOfTetrahedraDependsOnWhatWasKept) {
  SCOPED_TRACE("seed 413");
  const CubeBox box = cubeBox(3, 2, 2, Vec3::Zero(), 0.02);
  std::vector<Index4> tetrahedra;
  constexpr int kuhn[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  for (const Index8& cube : box.cube) {
    for (const auto& corner : kuhn) {
      tetrahedra.emplace_back(cube[static_cast<std::size_t>(corner[0])], cube[static_cast<std::size_t>(corner[1])],
                              cube[static_cast<std::size_t>(corner[2])], cube[static_cast<std::size_t>(corner[3])]);
    }
  }
  std::vector<bool> fixed(box.node.size(), false);
  for (int k = 0; k <= box.nz; ++k) {
    for (int j = 0; j <= box.ny; ++j) fixed[static_cast<std::size_t>(box.index(0, j, k))] = true;
  }
  const SolidModel model(box.node, tetrahedra, fixed, soft);
  SolidState state = restState(model);
  SerialExecutor executor;
  SolidSolver old;
  const SolidSolver::Settings settings = settingsWith(1.0 / 32.0);
  for (int step = 0; step < 40; ++step) {
    const Vec3 gravity(0.0, step % 20 < 10 ? -40.0 : 40.0, 5.0);
    SolidState again = state;
    SolidSolver fresh;
    old.freeMotion(model, state, gravity, {}, settings, executor);
    fresh.freeMotion(model, again, gravity, {}, settings, executor);
    ASSERT_EQ(old.freeVelocity(), fresh.freeVelocity()) << "step " << step;
    ASSERT_TRUE(old.advance(model, state, {}, settings.step));
  }
}

/// The grain is the matrix's alone: equilibrium is where forces are none, which do not know of it.
TEST(StiffnessAssembly, EquilibriumDoesNotKnowTheGrain) {
  const Carved carved;
  const SolidModel model = carved.model();
  SerialExecutor executor;
  std::array<SolidState, 2> state{restState(model), restState(model)};
  for (std::size_t k = 0; k < 2; ++k) {
    SolidSolver solver;
    SolidSolver::Settings settings = settingsWith(k == 0 ? 0.0 : 1.0 / 16.0);
    settings.step = 0.05;
    for (int step = 0; step < 400; ++step) {
      solver.freeMotion(model, state[k], Vec3(0.0, -9.81, 0.0), {}, settings, executor);
      ASSERT_TRUE(solver.advance(model, state[k], {}, settings.step));
    }
  }
  double droop = 0.0;
  double apart = 0.0;
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    droop = std::max(droop, (state[0].position[n] - model.rest()[n]).norm());
    apart = std::max(apart, (state[0].position[n] - state[1].position[n]).norm());
  }
  EXPECT_GT(droop, 2e-3);
  EXPECT_LT(apart, 1e-5 * droop);
}

/// The angle between a rotation and its grain is at most twice the grain, and grain 0 is the rotation itself.
TEST(Polar, RotationsToAGrain) {
  SCOPED_TRACE("seed 414");
  Random random(414);
  double largest = 0.0;
  for (int trial = 0; trial < 2000; ++trial) {
    RotationGroup q{};
    for (std::size_t l = 0; l < laneCount; ++l) {
      std::array<double, 4> raw{};
      double square = 0.0;
      for (double& x : raw) {
        x = random.normal();
        square += x * x;
      }
      for (std::size_t k = 0; k < 4; ++k) q[k][l] = raw[k] / std::sqrt(square);
    }
    RotationGroup same{};
    toGrain(q, 0.0, same);
    EXPECT_EQ(same, q);
    RotationGroup near{};
    toGrain(q, 1.0 / 32.0, near);
    for (std::size_t l = 0; l < laneCount; ++l) {
      double dot = 0.0;
      double square = 0.0;
      for (std::size_t k = 0; k < 4; ++k) {
        dot += q[k][l] * near[k][l];
        square += near[k][l] * near[k][l];
      }
      EXPECT_NEAR(square, 1.0, 1e-14);
      largest = std::max(largest, 2.0 * std::acos(std::min(1.0, dot)));
    }
  }
  EXPECT_LE(largest, 2.0 / 32.0);
  EXPECT_GT(largest, 1.0 / 32.0);
}

}  // namespace
}  // namespace calot
