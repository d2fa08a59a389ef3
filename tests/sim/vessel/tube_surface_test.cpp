// SPDX-License-Identifier: GPL-3.0-or-later
// The tube's skin: closed, outward, of the right size, the same function of State however it came about.
#include "sim/vessel/tube_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "sim/geometry/triangle_mesh.h"
#include "sim/math/random.h"
#include "sim/vessel/beam_solver.h"
#include "sim/vessel/beam_state.h"
#include "tests/sim/vessel/support/beams.h"

namespace calot {
namespace {

TriangleMesh meshOf(const TubeSurface& tube, const BeamState& state) {
  TriangleMesh mesh;
  tube.positions(state, mesh.vertex);
  mesh.triangle = tube.triangles();
  return mesh;
}

/// Every edge has two triangles that run along it in opposite directions, every vertex is used, no triangle is flat.
void expectClosed(const TriangleMesh& mesh) {
  std::vector<bool> used(mesh.vertex.size(), false);
  for (const Index3& t : mesh.triangle) {
    for (int k = 0; k < 3; ++k) {
      ASSERT_GE(t[k], 0);
      ASSERT_LT(t[k], mesh.vertices());
      used[slot(t[k])] = true;
    }
  }
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
  const std::vector<TriangleSide> sides = sortedSides(mesh);
  ASSERT_EQ(sides.size() % 2, 0U);
  for (std::size_t i = 0; i < sides.size(); i += 2) {
    ASSERT_EQ(sides[i].low, sides[i + 1].low);
    ASSERT_EQ(sides[i].high, sides[i + 1].high);
    ASSERT_NE(sides[i].forward, sides[i + 1].forward);
    if (i + 2 < sides.size()) {
      ASSERT_FALSE(sides[i].low == sides[i + 2].low && sides[i].high == sides[i + 2].high);
    }
  }
  for (int t = 0; t < mesh.triangles(); ++t) {
    const Vec3 normal = (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0));
    EXPECT_GT(normal.norm(), 1e-12) << t;
  }
}

TEST(TubeSurface, IsAClosedTubeOfTheRightVolume) {
  const BeamModel model({test::duct(40, true, true)});
  const BeamState state = restState(model);
  const double exact = std::numbers::pi * 0.0025 * 0.0025 * model.branches()[0].length();
  for (const std::size_t rings : {1U, 2U, 3U}) {
    const TubeSurface tube(model, 0, {8, rings});
    const TriangleMesh mesh = meshOf(tube, state);
    EXPECT_EQ(tube.vertices(), (40 * rings + 1) * 8 + 2);
    EXPECT_EQ(tube.triangles().size(), 2 * 8 * 40 * rings + 16);
    expectClosed(mesh);
    // An octagon has 90 % of its circle.
    const double octagon = 8.0 * 0.5 * std::sin(0.25 * std::numbers::pi) / std::numbers::pi;
    EXPECT_NEAR(signedVolume(mesh) / (octagon * exact), 1.0, 0.01);
  }
}

TEST(TubeSurface, PartingsCloseBothStumpsAndKeepNumbers) {
  const BeamModel model({test::duct(40, true, true)});
  for (const std::size_t rings : {1U, 3U}) {
    BeamState state = restState(model);
    TubeSurface tube(model, 0, {8, rings});
    const TriangleMesh before = meshOf(tube, state);
    EXPECT_FALSE(tube.update(state));
    part(state, pointAt(model, 0, 0.0201), Parting::cut);
    part(state, pointAt(model, 0, 0.0099), Parting::torn);
    part(state, pointAt(model, 0, 0.0001), Parting::cut);
    part(state, pointAt(model, 0, 1.0), Parting::cut);
    EXPECT_TRUE(tube.update(state));
    EXPECT_FALSE(tube.update(state));
    const TriangleMesh after = meshOf(tube, state);
    expectClosed(after);
    int components = 0;
    ASSERT_EQ(triangleComponents(after, components).size(), after.triangle.size());
    EXPECT_EQ(components, 5);
    EXPECT_GT(signedVolume(after), 0.98 * signedVolume(before));
    // Rings keep their vertices, except those inside parted elements, which make room.
    const std::size_t first = model.branches()[0].firstElement;
    for (std::size_t v = 0; v < (40 * rings + 1) * 8; ++v) {
      if (state.parting[tube.where(static_cast<int>(v)).element - first] != Parting::none) continue;
      EXPECT_LT((after.vertex[v] - before.vertex[v]).norm(), 1e-15);
    }
    // A surface that sees all partings at once is the same.
    TubeSurface fresh(model, 0, {8, rings});
    fresh.update(state);
    const TriangleMesh again = meshOf(fresh, state);
    ASSERT_EQ(again.triangle.size(), after.triangle.size());
    for (std::size_t t = 0; t < again.triangle.size(); ++t) EXPECT_EQ(again.triangle[t], after.triangle[t]);
    for (std::size_t v = 0; v < again.vertex.size(); ++v) EXPECT_EQ(again.vertex[v], after.vertex[v]);
  }
}

TEST(TubeSurface, AClipFlattensTheTubeWhereItIs) {
  const BeamModel model({test::duct(40, true, true)});
  BeamState state = restState(model);
  const TubeSurface tube(model, 0, {10, 2});
  const double roll = 0.4;
  const double place = model.branches()[0].arcLength[20];
  setClip(model, state, {pointAt(model, 0, place), 0.002, 0.01, 0.005, roll, 1.0}, 1.0);
  const TriangleMesh mesh = meshOf(tube, state);
  expectClosed(mesh);
  double thin = 0.0;
  double wide = 0.0;
  double far = 0.0;
  for (std::size_t v = 0; v < mesh.vertex.size(); ++v) {
    const BeamPoint where = tube.where(static_cast<int>(v));
    const Pose pose = centreLine(model, state, where);
    const Vec3 out = pose.orientation.conjugate() * (mesh.vertex[v] - pose.position);
    EXPECT_LT(std::abs(out[2]), 1e-12);
    if (std::abs(where.arcLength - place) < 0.0009) {
      thin = std::max(thin, std::abs(out[0] * std::cos(roll) + out[1] * std::sin(roll)));
      wide = std::max(wide, std::abs(out[1] * std::cos(roll) - out[0] * std::sin(roll)));
    } else if (std::abs(where.arcLength - place) > 0.001 + 1.5 * 0.0025) {
      far = std::max(far, out.norm());
    }
  }
  EXPECT_LT(thin, 0.001 + 1e-12);  // two walls of 1 mm
  EXPECT_GT(wide, 0.93 * 0.5 * std::numbers::pi * 0.0025);
  EXPECT_NEAR(far, 0.0025, 1e-12);
}

/// What contact relies on: a vertex moves with the nodes that it hangs on, by their weights, when these are pushed
/// along.
TEST(TubeSurface, VerticesFollowTheirNodes) {
  const BeamModel model({test::duct(40, true, true)});
  const TubeSurface tube(model, 0, {8, 3});
  const BeamState state = restState(model);
  std::vector<Vec3> before;
  std::vector<Vec3> after;
  tube.positions(state, before);
  for (const std::size_t node : {0U, 17U, 40U}) {
    BeamState moved = state;
    moved.position[node] += Vec3(0.0, 0.0, 1e-7);
    tube.positions(moved, after);
    for (std::size_t v = 0; v < before.size(); ++v) {
      const BeamInfluence& influence = tube.influence(static_cast<int>(v));
      double weight = 0.0;
      double sum = 0.0;
      for (std::size_t k = 0; k < influence.count; ++k) {
        sum += influence.weight[k];
        if (influence.node[k] == static_cast<int>(node)) weight += influence.weight[k];
      }
      EXPECT_NEAR(sum, 1.0, 1e-15);
      // Linear weights against the cubic line: off by at most an eighth.
      EXPECT_NEAR((after[v] - before[v])[2] / 1e-7, weight, 0.13);
    }
  }
}

/// Block Cholesky on a branching tree against a dense elimination.
TEST(BlockTree, SolvesWhatADenseSolverSolves) {
  Random random(21);
  const std::vector<int> parent{-1, 0, 1, 1, 3, 0, -1, 6, 7, 6};
  const std::size_t n = parent.size();
  BlockTree tree;
  tree.reset(n);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(static_cast<int>(6 * n), static_cast<int>(6 * n));
  for (std::size_t i = 0; i < n; ++i) {
    Eigen::Matrix<double, 6, 6> own;
    Eigen::Matrix<double, 6, 6> off;
    for (int k = 0; k < 36; ++k) {
      own(k) = random.normal();
      off(k) = random.normal();
    }
    own = (own * own.transpose()).eval();
    own.diagonal().array() += 40.0;
    if (parent[i] < 0) off.setZero();
    for (int r = 0; r < 6; ++r) {
      for (int c = 0; c < 6; ++c) {
        tree.diagonal(i)[6 * static_cast<std::size_t>(r) + static_cast<std::size_t>(c)] = own(r, c);
        tree.coupling(i)[6 * static_cast<std::size_t>(r) + static_cast<std::size_t>(c)] = off(r, c);
      }
    }
    const int at = static_cast<int>(6 * i);
    dense.block<6, 6>(at, at) = own;
    if (parent[i] >= 0) {
      dense.block<6, 6>(at, 6 * parent[i]) = off;
      dense.block<6, 6>(6 * parent[i], at) = off.transpose();
    }
  }
  ASSERT_TRUE(tree.factor(parent));
  std::vector<Vector6> x(n);
  Eigen::VectorXd b(static_cast<int>(6 * n));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < 6; ++k) {
      x[i][k] = random.normal();
      b[static_cast<int>(6 * i + k)] = x[i][k];
    }
  }
  tree.solve(parent, x);
  const Eigen::MatrixXd inverse = dense.inverse();
  const Eigen::VectorXd expected = inverse * b;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(x[i][k], expected[static_cast<int>(6 * i + k)], 1e-12);
  }
  std::vector<double> column(9 * n);
  tree.columns(parent, 4, column);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(column[9 * i + 3 * r + c], inverse(static_cast<int>(6 * i + r), static_cast<int>(24 + c)), 1e-12);
      }
    }
  }
  // An indefinite matrix is told, and what can be solved is finite.
  tree.reset(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < 6; ++k) tree.diagonal(i)[7 * k] = i == 3 ? -1.0 : 1.0;
  }
  EXPECT_FALSE(tree.factor(parent));
  tree.solve(parent, x);
  for (const Vector6& v : x) {
    for (const double value : v) EXPECT_TRUE(std::isfinite(value));
  }
}

}  // namespace
}  // namespace calot
