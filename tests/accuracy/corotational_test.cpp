// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/math/random.h"
#include "sim/solid/solid.h"
#include "tests/accuracy/support/kuhn_box.h"
#include "tests/accuracy/support/settle.h"

namespace calot {
namespace {

using test::KuhnBox;
using test::kuhnBox;

/// Patch test: boundary nodes of a jittered mesh displaced by a linear field, free interior: the interior must follow
/// the field. Small strain, so that the co-rotational law is linear elasticity.
TEST(Accuracy, PatchTest) {
  KuhnBox box = kuhnBox(4, 4, 4, Vec3(0.0, 0.0, 0.0), Vec3(0.1, 0.1, 0.1));
  Random random(7);
  std::vector<bool> fixed(box.node.size(), true);
  for (int k = 1; k < 4; ++k) {
    for (int j = 1; j < 4; ++j) {
      for (int i = 1; i < 4; ++i) {
        const auto n = static_cast<std::size_t>(box.index(i, j, k));
        fixed[n] = false;
        for (int a = 0; a < 3; ++a) box.node[n][a] += 0.004 * (random.uniform() - 0.5);
      }
    }
  }
  const SolidModel model(box.node, box.tetrahedron, fixed, {lameConstants(5e3, 0.45), 1000.0, 0.0, 0.05});
  SolidState state = restState(model);
  Mat3 gradient;
  gradient << 1.0, 0.3, -0.2, 0.3, -0.5, 0.4, -0.2, 0.4, 0.8;
  gradient *= 1e-3;
  for (std::size_t n = 0; n < box.node.size(); ++n) {
    if (fixed[n]) state.position[n] = box.node[n] + gradient * box.node[n];
  }
  test::settle(model, state, {});
  double worst = 0.0;
  for (std::size_t n = 0; n < box.node.size(); ++n) {
    worst = std::max(worst, (state.position[n] - box.node[n] - gradient * box.node[n]).norm());
  }
  EXPECT_LT(worst, 1e-3 * 1.5e-4);  // a thousandth of the largest displacement: float solves to 1e-6
}

/// A rigidly moved body has no elastic force, whatever the rotation, once the rotations have followed.
TEST(Accuracy, RigidMotionIsFree) {
  const KuhnBox box = kuhnBox(4, 3, 3, Vec3(0.0, 0.0, 0.0), Vec3(0.1, 0.08, 0.08));
  const TetrahedralElements elements(box.node, box.tetrahedron);
  SerialExecutor executor;
  Random random(11);
  for (int trial = 0; trial < 20; ++trial) {
    Quat turn(random.normal(), random.normal(), random.normal(), random.normal());
    turn.normalize();
    const Vec3 shift(random.normal(), random.normal(), random.normal());
    std::vector<Vec3> position;
    for (const Vec3& p : box.node) position.push_back(turn * p + shift);
    const std::vector<Vec3> still(box.node.size(), Vec3::Zero());
    RotationGroup identity{};
    identity[0].fill(1.0);
    std::vector<RotationGroup> rotation(elements.groups().size(), identity);
    std::vector<ElementResult> result(elements.groups().size());
    // Newton from any start: at most a few dozen bounded steps.
    elements.evaluate(position, still, 0.0, lameConstants(5e3, 0.45), 40, rotation, result, executor);
    double largest = 0.0;
    for (const ElementResult& r : result) {
      for (const auto& node : r.force) {
        for (const auto& component : node) {
          for (const double f : component) largest = std::max(largest, std::abs(f));
        }
      }
    }
    EXPECT_LT(largest, 1e-10) << "trial " << trial;
  }
}

/// Free body: elastic forces neither push nor turn it. Linear and angular momentum of a stretched, spinning box.
TEST(Accuracy, MomentumIsConserved) {
  const KuhnBox box = kuhnBox(4, 3, 3, Vec3(-0.05, -0.04, -0.04), Vec3(0.05, 0.04, 0.04));
  const SolidModel model(box.node, box.tetrahedron, std::vector<bool>(box.node.size(), false),
                         {lameConstants(5e3, 0.45), 1000.0, 0.0, 0.0});
  SolidState state = restState(model);
  const Vec3 drift(0.1, -0.2, 0.05);
  for (std::size_t n = 0; n < box.node.size(); ++n) {
    state.position[n] = 1.1 * box.node[n];
    state.velocity[n] = drift + Vec3(0.0, 0.0, 2.0).cross(box.node[n]);
  }
  const auto linear = [&] {
    Vec3 p = Vec3::Zero();
    for (std::size_t n = 0; n < box.node.size(); ++n) p += model.mass()[n] * state.velocity[n];
    return p;
  };
  const Vec3 before = linear();
  SerialExecutor executor;
  SolidSolver solver;
  SolidSolver::Settings settings;
  settings.step = 0.001;
  settings.tolerance = 1e-6;
  for (int i = 0; i < 200; ++i) {
    solver.solveUnconstrained(model, state, Vec3::Zero(), {}, settings, executor);
    ASSERT_TRUE(solver.advance(model, state, {}, settings.step));
  }
  EXPECT_LT((linear() - before).norm(), 1e-5 * before.norm());
}

/// Slender cantilever, small load: Euler-Bernoulli w = F L^3 / (3 E I), converging from below with the mesh.
TEST(Accuracy, CantileverConvergesToEulerBernoulli) {
  const double length = 0.2;
  const double side = 0.02;
  const double young = 1e5;
  const double force = 1e-3;
  const double expected = force * length * length * length / (3.0 * young * side * side * side * side / 12.0);
  double previous = 1.0;
  for (const int across : {2, 4}) {
    const KuhnBox box = kuhnBox(10 * across, across, across, Vec3::Zero(), Vec3(length, side, side));
    const SolidModel model(box.node, box.tetrahedron, box.firstFace(), {lameConstants(young, 0.0), 1000.0, 5.0, 0.02});
    SolidState state = restState(model);
    std::vector<Vec3> external(box.node.size(), Vec3::Zero());
    const int corners = (across + 1) * (across + 1);
    for (int k = 0; k <= across; ++k) {
      for (int j = 0; j <= across; ++j) {
        external[static_cast<std::size_t>(box.index(10 * across, j, k))] = Vec3(0.0, -force / corners, 0.0);
      }
    }
    test::settle(model, state, {Vec3::Zero(), external});
    const auto tip = static_cast<std::size_t>(box.index(10 * across, across / 2, across / 2));
    const double error = 1.0 + (state.position[tip][1] - box.node[tip][1]) / expected;
    EXPECT_GT(error, 0.0) << "linear tetrahedra are too stiff, never too soft";
    EXPECT_LT(error, 0.55 * previous) << across;
    previous = error;
  }
}

}  // namespace
}  // namespace calot
