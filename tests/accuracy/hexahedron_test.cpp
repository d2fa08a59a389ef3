// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sim/math/random.h"
#include "sim/solid/solid.h"
#include "tests/accuracy/support/cube_box.h"
#include "tests/accuracy/support/settle.h"

namespace calot {
namespace {

using test::CubeBox;
using test::cubeBox;

constexpr SolidModel::Material soft(double poisson = 0.3) {
  return {
      {5e3 * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), 5e3 / (2.0 * (1.0 + poisson))}, 1000.0, 0.0, 0.05};
}

void settle(const SolidModel& model, SolidState& state, std::span<const Vec3> external, const Surroundings& around = {},
            double step = 0.05) {
  ASSERT_LT(test::settle(model, state, {Vec3::Zero(), external, around, step, 4000, 1e-10}), 1e-7);
}

struct Forces {
  double largest = 0.0;
  Vec3 sum = Vec3::Zero();
  Vec3 moment = Vec3::Zero();
};

Forces forcesAt(const CubeBox& box, const HexahedralElements& elements, const std::vector<Vec3>& position,
                std::vector<Vec3>& nodal) {
  SerialExecutor executor;
  const std::vector<Vec3> still(position.size(), Vec3::Zero());
  RotationGroup identity{};
  identity[0].fill(1.0);
  std::vector<RotationGroup> rotation(elements.groups().size(), identity);
  std::vector<HexahedronResult> result(elements.groups().size());
  elements.evaluate(position, still, 0.0, 40, {}, rotation, result, executor);
  nodal.assign(position.size(), Vec3::Zero());
  for (std::size_t e = 0; e < box.cube.size(); ++e) {
    for (std::size_t a = 0; a < 8; ++a) {
      const auto& f = result[e / laneCount].force[a];
      nodal[static_cast<std::size_t>(box.cube[e][a])] += Vec3(f[0][e % 8], f[1][e % 8], f[2][e % 8]);
    }
  }
  Forces out;
  for (std::size_t n = 0; n < position.size(); ++n) {
    out.largest = std::max(out.largest, nodal[n].norm());
    out.sum += nodal[n];
    out.moment += position[n].cross(nodal[n]);
  }
  return out;
}

/// Springs in a known cube take a shorter way into the matrix: the same one, bit for bit.
TEST(Hexahedra, AKnownElementChangesNoBitOfASpring) {
  SCOPED_TRACE("seed 91");
  Random random(91);
  const CubeBox box = cubeBox(4, 3, 3, Vec3::Zero(), 0.02);
  std::vector<bool> fixed(box.node.size(), false);
  for (std::size_t n = 0; n < fixed.size(); n += 5) fixed[n] = true;
  const SolidModel model(box.node, box.cube, box.edge, fixed, soft());
  std::vector<Attachment> known;
  for (int i = 0; i < 60; ++i) {
    Attachment& a = known.emplace_back();
    const auto cube = static_cast<std::size_t>(random.uniform() * static_cast<double>(box.cube.size()));
    a.point.element = static_cast<int>(cube);
    a.point.node = box.cube[cube];
    a.point.count = 8;
    const Vec3 s{random.uniform(), random.uniform(), random.uniform()};
    for (std::size_t c = 0; c < 8; ++c) {
      a.point.weight[c] = ((c & 1U) != 0 ? s[0] : 1.0 - s[0]) * ((c >> 1U & 1U) != 0 ? s[1] : 1.0 - s[1]) *
                          ((c >> 2U & 1U) != 0 ? s[2] : 1.0 - s[2]);
    }
    a.force = Vec3{random.normal(), random.normal(), random.normal()};
    a.damper = random.uniform() * Mat3::Identity();
    if (i % 7 == 0) a.damper(1, 1) += 0.5;  // has a direction of its own
  }
  std::vector<Attachment> unknown = known;
  for (Attachment& a : unknown) a.point.element = -1;
  SerialExecutor executor;
  std::array<std::vector<Vec3>, 2> velocity;
  for (const auto& [loads, out] : {std::pair(&known, &velocity[0]), {&unknown, &velocity[1]}}) {
    SolidState state = restState(model);
    SolidSolver solver;
    EXPECT_TRUE(solver.solveUnconstrained(model, state, Vec3::Zero(), {}, {}, executor, {*loads, {}, {}}).converged);
    *out = solver.freeVelocity();
  }
  double largest = 0.0;
  for (const Vec3& v : velocity[0]) largest = std::max(largest, v.norm());
  EXPECT_GT(largest, 1e-3);
  for (std::size_t n = 0; n < velocity[0].size(); ++n) EXPECT_EQ(velocity[0][n], velocity[1][n]) << "node " << n;
}

/// A linear displacement of the boundary goes through the inside: exactly, as all cubes of the patch share one
/// rotation.
TEST(Hexahedra, PatchTestIsExact) {
  const CubeBox box = cubeBox(4, 4, 4, Vec3::Zero(), 0.025);
  const HexahedralElements elements(box.cube, box.edge, lameConstants(5e3, 0.45));
  Mat3 gradient;
  gradient << 1.0, 0.3, -0.2, 0.3, -0.5, 0.4, -0.2, 0.4, 0.8;  // symmetric: the polar rotation is the identity
  gradient *= 0.2;
  std::vector<Vec3> position;
  for (const Vec3& p : box.node) position.push_back(p + gradient * p);
  std::vector<Vec3> nodal;
  const Forces all = forcesAt(box, elements, position, nodal);
  ASSERT_GT(all.largest, 1e-3);  // the boundary is held
  for (int k = 1; k < 4; ++k) {
    for (int j = 1; j < 4; ++j) {
      for (int i = 1; i < 4; ++i) {
        EXPECT_LT(nodal[static_cast<std::size_t>(box.index(i, j, k))].norm(), 1e-13 * all.largest / 1e-3);
      }
    }
  }
  // Stress of the linear law on the face x = const: sigma = 2 mu eps + lambda tr(eps) I, traction times area.
  const LameConstants m = lameConstants(5e3, 0.45);
  const Mat3 stress = 2.0 * m.mu * gradient + m.lambda * gradient.trace() * Mat3::Identity();
  Vec3 pull = Vec3::Zero();
  for (int k = 0; k <= 4; ++k) {
    for (int j = 0; j <= 4; ++j) pull -= nodal[static_cast<std::size_t>(box.index(4, j, k))];
  }
  // The edges of the face carry shares of the other faces' tractions, which cancel.
  const Vec3 expected = stress.col(0) * (0.1 * 0.1);
  EXPECT_LT((pull - expected).norm(), 1e-12 * expected.norm() / 1e-3);
}

TEST(Hexahedra, RigidMotionIsFree) {
  const CubeBox box = cubeBox(3, 2, 4, Vec3(-0.02, 0.01, 0.05), 0.01);
  const HexahedralElements elements(box.cube, box.edge, lameConstants(5e3, 0.45));
  Random random(23);
  for (int trial = 0; trial < 20; ++trial) {
    Quat turn(random.normal(), random.normal(), random.normal(), random.normal());
    turn.normalize();
    const Vec3 shift(random.normal(), random.normal(), random.normal());
    std::vector<Vec3> position;
    for (const Vec3& p : box.node) position.push_back(turn * p + shift);
    std::vector<Vec3> nodal;
    EXPECT_LT(forcesAt(box, elements, position, nodal).largest, 1e-10) << trial;
  }
}

/// Forces of any deformation add up to nothing, and so do their moments where the strain is small: the co-rotational
/// law takes the rotation as given.
TEST(Hexahedra, ForcesNeitherPushNorTurn) {
  const CubeBox box = cubeBox(3, 3, 3, Vec3::Constant(-0.015), 0.01);
  const HexahedralElements elements(box.cube, box.edge, lameConstants(5e3, 0.45));
  Random random(5);
  Quat turn(random.normal(), random.normal(), random.normal(), random.normal());
  turn.normalize();
  for (const double size : {1e-3, 1e-4}) {
    std::vector<Vec3> position;
    for (const Vec3& p : box.node) {
      position.push_back(turn * Vec3(p + 0.01 * size * Vec3(random.normal(), random.normal(), random.normal())));
    }
    std::vector<Vec3> nodal;
    const Forces f = forcesAt(box, elements, position, nodal);
    EXPECT_LT(f.sum.norm(), 1e-11 * f.largest);
    EXPECT_LT(f.moment.norm(), 10.0 * size * 0.01 * f.largest);
  }
}

/// The stiffness of the linear system is the derivative of the forces at rest.
TEST(Hexahedra, StiffnessIsTheDerivativeOfTheForces) {
  const CubeBox box = cubeBox(1, 1, 1, Vec3::Zero(), 0.01);
  const HexahedralElements elements(box.cube, box.edge, lameConstants(5e3, 0.45));
  double largest = 0.0;
  for (const auto& row : elements.stiffness()) {
    for (const double k : row) largest = std::max(largest, std::abs(k));
  }
  for (std::size_t b = 0; b < 8; ++b) {
    for (int j = 0; j < 3; ++j) {
      std::vector<Vec3> position = box.node;
      std::vector<Vec3> nodal;
      const double eps = 1e-8;
      position[static_cast<std::size_t>(box.cube[0][b])][j] += eps;
      forcesAt(box, elements, position, nodal);
      for (std::size_t a = 0; a < 8; ++a) {
        for (int i = 0; i < 3; ++i) {
          const double slope = -nodal[static_cast<std::size_t>(box.cube[0][a])][i] / eps;
          EXPECT_NEAR(slope,
                      elements.stiffness()[3 * a + static_cast<std::size_t>(i)][3 * b + static_cast<std::size_t>(j)],
                      1e-4 * largest);
        }
      }
    }
  }
}

/// Tip of a clamped beam under a small end load.
double tipOf(int across, double length, double side, double young, double poisson, double force) {
  const double edge = side / across;
  const int along = static_cast<int>(length / edge + 0.5);
  const CubeBox box = cubeBox(along, across, across, Vec3::Zero(), edge);
  std::vector<bool> fixed(box.node.size(), false);
  std::vector<Vec3> external(box.node.size(), Vec3::Zero());
  const int corners = (across + 1) * (across + 1);
  for (int k = 0; k <= across; ++k) {
    for (int j = 0; j <= across; ++j) {
      fixed[static_cast<std::size_t>(box.index(0, j, k))] = true;
      external[static_cast<std::size_t>(box.index(along, j, k))] = Vec3(0.0, -force / corners, 0.0);
    }
  }
  const SolidModel model(box.node, box.cube, edge, fixed, {lameConstants(young, poisson), 1000.0, 20.0, 0.1});
  SolidState state = restState(model);
  settle(model, state, external, {}, 0.1);
  const auto tip = static_cast<std::size_t>(box.index(along, across / 2, across / 2));
  return -(state.position[tip][1] - box.node[tip][1]);
}

/// Second order in the cell: the error against Timoshenko's beam (w = F L^3 / 3EI + F L / k G A, k = 5/6) falls to a
/// quarter with half the cell.
TEST(Hexahedra, CantileverConvergesAtSecondOrder) {
  const double length = 0.16;
  const double side = 0.02;
  const double young = 1e5;
  const double force = 1e-3;
  const double inertia = side * side * side * side / 12.0;
  const double expected = force * length * length * length / (3.0 * young * inertia) +
                          force * length / (5.0 / 6.0 * (0.5 * young) * side * side);
  double previous = 0.0;
  for (const int across : {2, 4, 8}) {
    const double error = 1.0 - tipOf(across, length, side, young, 0.0, force) / expected;
    EXPECT_GT(error, 0.0) << across;
    if (previous > 0.0) {
      EXPECT_LT(error, previous / 3.4) << across;
      EXPECT_GT(error, previous / 4.6) << across;
    }
    previous = error;
  }
  EXPECT_LT(previous, 0.02);
}

/// Nearly incompressible tissue does not lock: Poisson's ratio 0.49 leaves the droop of a beam, which hardly depends on
/// it, within a few per cent.
TEST(Hexahedra, NearlyIncompressibleDoesNotLock) {
  const double plain = tipOf(4, 0.16, 0.02, 1e5, 0.0, 1e-3);
  const double tight = tipOf(4, 0.16, 0.02, 1e5, 0.49, 1e-3);
  EXPECT_NEAR(tight, plain, 0.08 * plain);
}

/// Half full cubes carry half: twice the stretch under the same load, half the mass; empty ones hold their orphaned
/// nodes where they were and leave the rest alone.
TEST(Hexahedra, FillScalesStiffnessAndEmptyCubesLeave) {
  const CubeBox box = cubeBox(6, 2, 2, Vec3::Zero(), 0.01);
  std::vector<bool> fixed(box.node.size(), false);
  std::vector<Vec3> external(box.node.size(), Vec3::Zero());
  for (int k = 0; k <= 2; ++k) {
    for (int j = 0; j <= 2; ++j) {
      fixed[static_cast<std::size_t>(box.index(0, j, k))] = true;
      external[static_cast<std::size_t>(box.index(4, j, k))] = Vec3(1e-3 / 9.0, 0.0, 0.0);
    }
  }
  const SolidModel model(box.node, box.cube, box.edge, fixed, soft());
  const auto stretch = [&](double share) {
    std::vector<double> fill;
    for (std::size_t e = 0; e < box.cube.size(); ++e) fill.push_back(e % 6 < 4 ? share : 0.0);
    SolidState state = restState(model);
    settle(model, state, external, {{}, fill});
    for (int k = 0; k <= 2; ++k) {
      for (int j = 0; j <= 2; ++j) {
        const auto n = static_cast<std::size_t>(box.index(6, j, k));
        EXPECT_EQ(state.position[n], box.node[n]);
      }
    }
    EXPECT_NEAR(model.volume(state.position, fill), share * 16e-6, 0.01 * share * 16e-6);
    return state.position[static_cast<std::size_t>(box.index(4, 1, 1))][0] - 0.04;
  };
  const double full = stretch(1.0);
  EXPECT_GT(full, 1e-5);
  EXPECT_NEAR(stretch(0.5), 2.0 * full, 2e-3 * full);
}

/// A free block hung on a spring: it comes to rest where the spring's force balances its load, and swings before that
/// with the period of mass and spring.
TEST(Attachments, BlockOnASpring) {
  const CubeBox box = cubeBox(2, 2, 2, Vec3::Constant(-0.01), 0.01);
  const SolidModel model(box.node, box.cube, box.edge, std::vector<bool>(box.node.size(), false),
                         {lameConstants(1e5, 0.3), 1000.0, 0.0, 0.0});
  double mass = 0.0;
  for (const double m : model.mass()) mass += m;
  EXPECT_NEAR(mass, 0.008, 1e-12);
  const double stiffness = 2.0;
  Attachment spring;
  spring.point.node[0] = box.index(1, 1, 1);
  spring.point.weight[0] = 1.0;
  spring.point.count = 1;
  SolidState state = restState(model);
  for (Vec3& p : state.position) p += Vec3(0.0, 0.001, 0.0);
  SerialExecutor executor;
  SolidSolver solver;
  SolidSolver::Settings settings;
  settings.step = 0.001;
  settings.tolerance = 1e-6;
  double crossing = 0.0;
  const auto middle = static_cast<std::size_t>(box.index(1, 1, 1));
  for (int i = 0; i < 400 && crossing == 0.0; ++i) {
    const double before = state.position[middle][1];
    spring.force = -stiffness * state.position[middle];
    spring.damper = settings.step * stiffness * Mat3::Identity();
    solver.solveUnconstrained(model, state, Vec3::Zero(), {}, settings, executor, {{&spring, 1}, {}});
    ASSERT_TRUE(solver.advance(model, state, {}, settings.step));
    const double after = state.position[middle][1];
    if (before > 0.0 && after <= 0.0) crossing = settings.step * (i + before / (before - after));
  }
  // A quarter of 2 pi sqrt(m / k); implicit Euler damps a little.
  EXPECT_NEAR(crossing, 0.5 * 3.14159265358979 * std::sqrt(mass / stiffness), 0.02 * crossing);
}

/// A stiff spring at a place inside a cube is as stable as a soft one, at any step.
TEST(Attachments, StiffSpringsAreStable) {
  const CubeBox box = cubeBox(2, 2, 2, Vec3::Constant(-0.01), 0.01);
  const SolidModel model(box.node, box.cube, box.edge, std::vector<bool>(box.node.size(), false), soft(0.45));
  for (const double stiffness : {1.0, 1e3, 1e6}) {
    Attachment spring;
    for (std::size_t a = 0; a < 8; ++a) {
      spring.point.node[a] = box.cube[0][a];
      spring.point.weight[a] = 0.125;
    }
    spring.point.count = 8;
    SolidState state = restState(model);
    SerialExecutor executor;
    SolidSolver solver;
    SolidSolver::Settings settings;
    settings.step = 0.02;
    const Vec3 target(0.01, 0.02, -0.005);
    for (int i = 0; i < 600; ++i) {
      spring.force = stiffness * (target - spring.point.of(state.position));
      spring.damper = (settings.step * stiffness + 0.05) * Mat3::Identity();
      solver.solveUnconstrained(model, state, Vec3::Zero(), {}, settings, executor, {{&spring, 1}, {}});
      ASSERT_TRUE(solver.advance(model, state, {}, settings.step));
      for (const Vec3& p : state.position) ASSERT_LT(p.norm(), 0.2);
    }
    // It hangs by a corner and spins on: the softer the spring, the farther out.
    EXPECT_LT((spring.point.of(state.position) - target).norm(), 1e-3) << stiffness;
  }
}

}  // namespace
}  // namespace calot
