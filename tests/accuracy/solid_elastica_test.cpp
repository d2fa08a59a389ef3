// SPDX-License-Identifier: GPL-3.0-or-later
// Large deflection of slender solids: the strain is small and the rotation is not, which is what a co-rotational law is
// for. Against the elastica.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "tests/accuracy/support/cube_box.h"
#include "tests/accuracy/support/elastica.h"
#include "tests/accuracy/support/kuhn_box.h"
#include "tests/accuracy/support/settle.h"
#include "tests/bench/growth_exponent.h"

namespace calot::solid_elastica_test {
namespace {

constexpr double length = 0.2;  // m
constexpr double side = 0.01;
constexpr double young = 1e5;  // Pa; nu = 0, as the elastica knows no other

template <class Box>
test::TipMotion tipOf(const Box& box, const SolidModel& model, double load) {
  const double force = load * young * std::pow(side, 4) / 12.0 / (length * length);
  const int corners = (box.ny + 1) * (box.nz + 1);
  std::vector<Vec3> external(box.node.size(), Vec3::Zero());
  for (int k = 0; k <= box.nz; ++k) {
    for (int j = 0; j <= box.ny; ++j) {
      external[static_cast<std::size_t>(box.index(box.nx, j, k))] = Vec3(0.0, -force / corners, 0.0);
    }
  }
  SolidState state = restState(model);
  EXPECT_LT(test::settle(model, state, {Vec3::Zero(), external, {}, 0.1, 4000, 1e-7}), 1e-6);
  Vec3 moved = Vec3::Zero();  // mean over the end's nodes: the axis' end
  for (int k = 0; k <= box.nz; ++k) {
    for (int j = 0; j <= box.ny; ++j) {
      const auto n = static_cast<std::size_t>(box.index(box.nx, j, k));
      moved += (state.position[n] - box.node[n]) / (corners * length);
    }
  }
  return {-moved[1], -moved[0]};
}

test::TipMotion ofCubes(int across, double load) {
  const test::CubeBox box = test::cubeBox(20 * across, across, across, Vec3::Zero(), side / across);
  return tipOf(box, {box.node, box.cube, box.edge, box.firstFace(), {lameConstants(young, 0.0), 100.0, 5.0, 0.05}},
               load);
}

test::TipMotion ofTetrahedra(int across, double load) {
  const test::KuhnBox box = test::kuhnBox(20 * across, across, across, Vec3::Zero(), Vec3(length, side, side));
  return tipOf(box, {box.node, box.tetrahedron, box.firstFace(), {lameConstants(young, 0.0), 100.0, 5.0, 0.05}}, load);
}

/// Cubes, whose bending locks little, come within a hundredth; tetrahedra, which have one strain each, are far too
/// stiff in bars of a few cells across, and fall towards it: second order is in sight, not reached.
TEST(SolidElastica, TipForce) {
  for (const double load : {1.0, 2.0}) {
    const test::TipMotion exact = test::elastica(load);
    for (const bool cubes : {true, false}) {
      std::vector<double> size;
      std::vector<double> error;
      for (const int across : {2, 4}) {
        const test::TipMotion tip = cubes ? ofCubes(across, load) : ofTetrahedra(across, load);
        size.push_back(1.0 / across);
        error.push_back(std::hypot(tip.down - exact.down, tip.back - exact.back) / std::hypot(exact.down, exact.back));
        std::printf("load %.0f, %s, %d across: w/L %.4f (exact %.4f) u/L %.4f (exact %.4f), error %.4f\n", load,
                    cubes ? "cubes" : "tetrahedra", across, tip.down, exact.down, tip.back, exact.back, error.back());
        EXPECT_LT(tip.down, exact.down) << "too stiff, never too soft";
      }
      const double order = bench::growthExponent(size, error);
      std::printf("order %.2f\n", order);
      EXPECT_LT(error.back(), cubes ? 0.01 : 0.18);
      EXPECT_GT(order, cubes ? 1.7 : 1.3);
      EXPECT_LT(order, 2.4);
    }
  }
}

}  // namespace
}  // namespace calot::solid_elastica_test
