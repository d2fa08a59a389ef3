// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies that carry their weight by loads of their elements, alone: against closed solutions, and by what such loads
// must not do.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "sim/math/random.h"
#include "sim/scene/weight_system.h"
#include "sim/vessel/beam_model.h"
#include "sim/vessel/beam_state.h"
#include "tests/accuracy/support/cube_box.h"
#include "tests/accuracy/support/kuhn_box.h"
#include "tests/accuracy/support/settle.h"
#include "tests/sim/vessel/support/beams.h"

namespace calot {
namespace {

constexpr double density = 1000.0;  // kg/m^3

/// x of K x = M g.
std::vector<Vec3> solveWeight(const SolidModel& model, const Vec3& gravity) {
  std::vector<int> row;
  int rows = 0;
  for (std::size_t n = 0; n < model.nodes(); ++n) row.push_back(model.row(n) < 0 ? -1 : rows++);
  SymmetricBlocks matrix(static_cast<std::size_t>(rows));
  addStiffness(model, {}, 1.0, row, matrix);
  std::vector<Vec3> weight;
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    if (row[n] >= 0) weight.emplace_back(model.mass()[n] * gravity);
  }
  EXPECT_EQ(matrix.factor(), 0U);
  const std::vector<Vec3> x = matrix.solve(weight);
  std::vector<Vec3> out(model.nodes(), Vec3::Zero());
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    if (row[n] >= 0) out[n] = x[static_cast<std::size_t>(row[n])];
  }
  return out;
}

enum class Kind { tetrahedra, cubes };

/// A bar along x, held at x = 0.
SolidModel bar(Kind kind, double young, double poisson) {
  const SolidModel::Material material{lameConstants(young, poisson), density, 2.0, 0.02};
  if (kind == Kind::cubes) {
    const test::CubeBox box = test::cubeBox(12, 4, 4, Vec3(0.0, -0.01, -0.01), 0.005);
    return {box.node, box.cube, box.edge, box.firstFace(), material};
  }
  const test::KuhnBox box = test::kuhnBox(12, 4, 4, Vec3(0.0, -0.01, -0.01), Vec3(0.06, 0.01, 0.01));
  return {box.node, box.tetrahedron, box.firstFace(), material};
}

class PreloadedBar : public testing::TestWithParam<Kind> {};

/// u(x) = rho g / E (L x - x^2 / 2) of a bar that does not contract sideways, over its sections.
TEST_P(PreloadedBar, HangsAsABarDoes) {
  const SolidModel model = bar(GetParam(), 20e3, 0.0);
  const std::vector<Vec3> x = solveWeight(model, Vec3(9.81, 0.0, 0.0));
  const double tip = density * 9.81 / 20e3 * 0.5 * 0.06 * 0.06;
  for (int section = 1; section <= 12; ++section) {
    const double at = 0.005 * section;
    double mean = 0.0;
    double nodes = 0.0;
    for (std::size_t n = 0; n < model.nodes(); ++n) {
      if (std::abs(model.rest()[n][0] - at) > 1e-6) continue;
      mean += x[n][0];
      nodes += 1.0;
    }
    EXPECT_EQ(nodes, 25.0);
    EXPECT_NEAR(mean / nodes, density * 9.81 / 20e3 * (0.06 * at - 0.5 * at * at), 0.01 * tip);
  }
}

/// Loaded, it stays where it is under its weight; without its weight it springs back by x, and under it again it
/// returns.
TEST_P(PreloadedBar, SpringsToItsFreeShapeAndBack) {
  SolidModel model = bar(GetParam(), 200e3, 0.3);
  const Vec3 gravity(0.0, -9.81, 0.0);
  const std::vector<Vec3> x = solveWeight(model, gravity);
  double largest = 0.0;
  for (const Vec3& u : x) largest = std::max(largest, u.norm());
  model.preload(x);
  SolidState state = restState(model);
  ASSERT_LT(test::settle(model, state, {gravity, {}, {}, 0.05}), 1e-9);
  double away = 0.0;
  for (std::size_t n = 0; n < model.nodes(); ++n) away = std::max(away, (state.position[n] - model.rest()[n]).norm());
  EXPECT_LT(away, 1e-9);
  ASSERT_LT(test::settle(model, state, {Vec3::Zero(), {}, {}, 0.05}), 1e-9);
  double error = 0.0;
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    error = std::max(error, (state.position[n] - (model.rest()[n] - x[n])).norm());
  }
  std::printf("sag %.3f mm; without weight it misses its free shape by %.4f mm\n", 1e3 * largest, 1e3 * error);
  EXPECT_GT(largest, 1e-3);
  EXPECT_LT(error, 0.03 * largest) << "to first order in the sag";
  ASSERT_LT(test::settle(model, state, {gravity, {}, {}, 0.05}), 1e-9);
  away = 0.0;
  for (std::size_t n = 0; n < model.nodes(); ++n) away = std::max(away, (state.position[n] - model.rest()[n]).norm());
  EXPECT_LT(away, 1e-7);
}

/// Forces on all nodes at positions, with the rotations that belong to them.
std::vector<Vec3> forcesOf(const SolidModel& model, const std::vector<Vec3>& position,
                           std::vector<RotationGroup>* rotation = nullptr) {
  SolidState state = restState(model);
  SerialExecutor executor;
  std::vector<Vec3> out(model.nodes(), Vec3::Zero());
  if (model.madeOfCubes()) {
    std::vector<HexahedronResult> result(model.groups());
    model.hexahedra().evaluate(position, state.velocity, 0.0, 40, {}, state.rotation, result, executor);
    for (std::size_t e = 0; e < model.cubes().size(); ++e) {
      for (std::size_t a = 0; a < 8; ++a) {
        const auto& f = result[e / laneCount].force[a];
        out[static_cast<std::size_t>(model.cubes()[e][a])] +=
            Vec3(f[0][e % laneCount], f[1][e % laneCount], f[2][e % laneCount]);
      }
    }
  } else {
    std::vector<ElementResult> result(model.groups());
    model.elements().evaluate(position, state.velocity, 0.0, model.material().lame, 40, state.rotation, result,
                              executor);
    for (std::size_t e = 0; e < model.tetrahedra().size(); ++e) {
      for (int a = 0; a < 4; ++a) {
        const auto& f = result[e / laneCount].force[static_cast<std::size_t>(a)];
        out[static_cast<std::size_t>(model.tetrahedra()[e][a])] +=
            Vec3(f[0][e % laneCount], f[1][e % laneCount], f[2][e % laneCount]);
      }
    }
  }
  if (rotation != nullptr) *rotation = state.rotation;
  return out;
}

/// The nodes at rest, each moved at random within a cube of this edge (m).
std::vector<Vec3> strainedShape(const SolidModel& model, double edge, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3> shape = model.rest();
  for (Vec3& p : shape) {
    const double x = random.uniform();
    const double y = random.uniform();
    p += edge * (Vec3(x, y, random.uniform()) - Vec3::Constant(0.5));
  }
  return shape;
}

/// Turned as a whole, strained or not, its forces are the same, turned.
TEST_P(PreloadedBar, ForcesTurnWithTheBody) {
  SolidModel model = bar(GetParam(), 5e3, 0.45);
  model.preload(solveWeight(model, Vec3(1.0, -9.0, -3.0)));
  const std::vector<Vec3> strained = strainedShape(model, 4e-4, 5);
  for (const std::vector<Vec3>& shape : {model.rest(), strained}) {
    const std::vector<Vec3> before = forcesOf(model, shape);
    double largest = 0.0;
    for (const Vec3& f : before) largest = std::max(largest, f.norm());
    ASSERT_GT(largest, 1e-4);
    const Quat turn = normalised(Quat(0.6, 0.5, -0.4, 0.3));
    std::vector<Vec3> turned;
    for (const Vec3& p : shape) turned.emplace_back(turn * p + Vec3(0.1, -0.2, 0.3));
    const std::vector<Vec3> after = forcesOf(model, turned);
    for (std::size_t n = 0; n < before.size(); ++n)
      EXPECT_LT((after[n] - turn * before[n]).norm(), 1e-9 * largest) << n;
  }
}

/// Loads of elements neither push nor turn the body as a whole: not at rest, and, of tetrahedra, in no shape.
TEST_P(PreloadedBar, LoadsHaveNoResultant) {
  SolidModel model = bar(GetParam(), 5e3, 0.45);
  model.preload(solveWeight(model, Vec3(1.0, -9.0, -3.0)));
  const std::vector<Vec3> strained = strainedShape(model, 2e-3, 6);
  for (const bool isStrained : {false, true}) {
    const std::vector<Vec3>& shape = isStrained ? strained : model.rest();
    const std::vector<Vec3> force = forcesOf(model, shape);
    Vec3 push = Vec3::Zero();
    Vec3 turn = Vec3::Zero();
    double sum = 0.0;
    for (std::size_t n = 0; n < force.size(); ++n) {
      push += force[n];
      turn += shape[n].cross(force[n]);
      sum += force[n].norm();
    }
    EXPECT_LT(push.norm(), 1e-12 * sum);
    if (GetParam() == Kind::cubes && isStrained) continue;
    EXPECT_LT(turn.norm(), 1e-12 * sum);
  }
}

INSTANTIATE_TEST_SUITE_P(Both, PreloadedBar, testing::Values(Kind::tetrahedra, Kind::cubes),
                         [](const auto& kind) { return kind.param == Kind::cubes ? "cubes" : "tetrahedra"; });

/// Kinetic energy, energy of tetrahedra and of their loads, height: kicked and left alone, their sum never grows.
TEST(PreloadedTetrahedra, GainNoEnergy) {
  const Vec3 gravity(0.0, -9.81, 0.0);
  const SolidModel plain = bar(Kind::tetrahedra, 60e3, 0.45);
  SolidModel model = plain;
  const std::vector<Vec3> x = solveWeight(plain, gravity);
  model.preload(x);
  const auto energy = [&](const SolidState& state) {
    const SolidState rest = restState(plain);
    std::vector<RotationGroup> rotation = state.rotation;
    SerialExecutor executor;
    std::vector<ElementResult> elastic(model.groups());
    std::vector<ElementResult> whole(model.groups());
    const LameConstants lame = plain.material().lame;
    plain.elements().evaluate(state.position, rest.velocity, 0.0, lame, 8, rotation, elastic, executor);
    model.elements().evaluate(state.position, rest.velocity, 0.0, lame, 0, rotation, whole, executor);
    double sum = 0.0;
    for (std::size_t n = 0; n < model.nodes(); ++n) {
      sum += model.mass()[n] * (0.5 * state.velocity[n].squaredNorm() - gravity.dot(state.position[n]));
    }
    for (std::size_t e = 0; e < plain.tetrahedra().size(); ++e) {
      const Mat3 r = rotationOf(rotation, static_cast<int>(e));
      for (int a = 0; a < 4; ++a) {
        const auto forceOf = [&](const ElementResult& result) {
          const auto& f = result.force[static_cast<std::size_t>(a)];
          return Vec3(f[0][e % laneCount], f[1][e % laneCount], f[2][e % laneCount]);
        };
        const auto n = static_cast<std::size_t>(plain.tetrahedra()[e][a]);
        // V sigma : eps / 2 and V sigma_0 : eps
        const Vec3 own = forceOf(elastic[e / laneCount]);
        const Vec3 load = forceOf(whole[e / laneCount]) - own;
        sum -= (0.5 * own + load).dot(state.position[n] - r * plain.rest()[n]);
      }
    }
    return sum;
  };
  SolidState state = restState(model);
  const double still = energy(state);
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    if (model.row(n) >= 0) state.velocity[n] = Vec3(0.0, 0.1, 0.08) * (model.rest()[n][0] / 0.06);
  }
  const double kick = energy(state) - still;
  SerialExecutor executor;
  SolidSolver solver;
  SolidSolver::Settings settings;
  settings.tolerance = 1e-6;
  settings.cap = 2000;
  double before = kick;
  double gained = 0.0;
  for (int i = 0; i < 1000; ++i) {
    solver.solveUnconstrained(model, state, gravity, {}, settings, executor);
    ASSERT_TRUE(solver.advance(model, state, {}, settings.step));
    const double now = energy(state) - still;
    gained = std::max(gained, now - before);
    before = now;
  }
  std::printf("kick %.2e J: gained in a step at most %.1e of it; left %.1e\n", kick, gained / kick, before / kick);
  EXPECT_LT(gained, 1e-9 * kick);
  EXPECT_LT(std::abs(before), 1e-3 * kick);
}

/// x of K x = M g of a beam: displacements, then rotations.
struct BeamAnswer {
  std::vector<Vec3> displacement, rotation;
};
BeamAnswer solveWeight(const BeamModel& model, const Vec3& gravity) {
  std::vector<int> row;
  int rows = 0;
  std::vector<Vec3> weight;
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    row.push_back(model.fixed(n) ? -1 : rows);
    if (model.fixed(n)) continue;
    rows += 2;
    weight.emplace_back(model.mass()[n] * gravity);
    weight.emplace_back(Vec3::Zero());
  }
  SymmetricBlocks matrix(static_cast<std::size_t>(rows));
  addStiffness(model, 1.0, row, matrix);
  EXPECT_EQ(matrix.factor(), 0U);
  const std::vector<Vec3> x = matrix.solve(weight);
  BeamAnswer out{std::vector<Vec3>(model.nodes(), Vec3::Zero()), std::vector<Vec3>(model.nodes(), Vec3::Zero())};
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    if (row[n] < 0) continue;
    out.displacement[n] = x[static_cast<std::size_t>(row[n])];
    out.rotation[n] = x[static_cast<std::size_t>(row[n]) + 1];
  }
  return out;
}

/// w = q L^4 / 8 EI at the tip, q L^3 / 6 EI its slope; one-point elements are low by 1 / n^2.
TEST(PreloadedBeam, SagsAsACantileverDoes) {
  for (const std::size_t elements : {20U, 40U}) {
    const BeamModel model({test::unitBeam(elements, true)});
    const double g = 1e-3;
    const BeamAnswer x = solveWeight(model, Vec3(0.0, -g, 0.0));
    const double error = x.displacement.back()[1] / (-g / 8.0) - 1.0;
    const double slope = x.rotation.back()[2] / (-g / 6.0) - 1.0;
    std::printf("cantilever, %zu elements: tip off by %.2e, slope by %.2e\n", elements, error, slope);
    EXPECT_LT(std::abs(error), 1.0 / static_cast<double>(elements * elements));
    EXPECT_LT(std::abs(slope), 1.0 / static_cast<double>(elements * elements));
  }
}

TEST(PreloadedBeam, SpringsToItsFreeShapeAndBack) {
  BeamModel model({test::unitBeam(40, true, 100.0)});
  BeamLoads loads;
  loads.gravity = Vec3(0.0, -0.2, 0.05);
  const BeamAnswer x = solveWeight(model, loads.gravity);
  preload(model, x.displacement, x.rotation);
  BeamState state = restState(model);
  ASSERT_LT(test::settle(model, state, loads, 0.5, 4000, 1e-12), 1e-12);
  EXPECT_LT((state.position.back() - model.rest().back()).norm(), 1e-9);
  BeamLoads none;
  ASSERT_LT(test::settle(model, state, none, 0.5, 4000, 1e-12), 1e-12);
  const double sag = x.displacement.back().norm();
  const double error = (state.position.back() - (model.rest().back() - x.displacement.back())).norm();
  std::printf("beam: sag %.4f, misses its free shape by %.1e\n", sag, error);
  EXPECT_LT(error, sag * sag) << "to first order";
  ASSERT_LT(test::settle(model, state, loads, 0.5, 4000, 1e-12), 1e-12);
  EXPECT_LT((state.position.back() - model.rest().back()).norm(), 1e-8);
}

TEST(PreloadedBeam, ForcesTurnWithTheBody) {
  BeamModel model({test::duct(20, true, true)});
  const BeamAnswer x = solveWeight(model, Vec3(1.0, -9.0, -3.0));
  preload(model, x.displacement, x.rotation);
  const BeamState rest = restState(model);
  BeamState turned = rest;
  const Quat turn = normalised(Quat(0.6, 0.5, -0.4, 0.3));
  for (Vec3& p : turned.position) p = turn * p;
  for (Quat& q : turned.orientation) q = normalised(turn * q);
  double largest = 0.0;
  for (std::size_t e = 0; e < model.elements().size(); ++e) {
    const BeamStrain a = strainOf(model.elements()[e], rest, e);
    const BeamStrain b = strainOf(model.elements()[e], turned, e);
    largest = std::max(largest, a.force.norm());
    EXPECT_LT((b.force - turn * a.force).norm(), 1e-12);
    EXPECT_LT((b.moment - turn * a.moment).norm(), 1e-14);
  }
  EXPECT_GT(largest, 1e-4);
}

}  // namespace
}  // namespace calot
