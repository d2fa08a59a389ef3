// SPDX-License-Identifier: GPL-3.0-or-later
// Large deflections of beams against closed solutions and published ones.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/accuracy/support/elastica.h"
#include "tests/sim/vessel/support/beams.h"

namespace calot {
namespace {

using test::elastica;
using test::TipMotion;

TipMotion tipOf(std::size_t elements, double load) {
  const BeamModel model({test::unitBeam(elements, true)});
  BeamState state = restState(model);
  std::vector<Vec3> force(model.nodes(), Vec3::Zero());
  force.back() = Vec3(0.0, 0.0, -load);
  BeamLoads loads;
  loads.force = force;
  EXPECT_LT(test::settle(model, state, loads, 1.0, 20000, 1e-11), 1e-11);
  const Vec3 moved = state.position.back() - model.rest().back();
  return {-moved[2], -moved[0]};
}

/// Published: Mattiasson 1981, Int. J. Numer. Meth. Engng 17:145, cantilever under a point load, five digits of them.
TEST(Elastica, ClosedSolutionIsThePublishedTable) {
  const std::array<std::array<double, 3>, 4> table{
      {{1.0, 0.30172, 0.05643}, {2.0, 0.49346, 0.16064}, {5.0, 0.71379, 0.38763}, {10.0, 0.81061, 0.55500}}};
  for (const auto& row : table) {
    const TipMotion exact = elastica(row[0]);
    std::printf("elastica P L^2 / EI = %4.1f: w/L %.8f u/L %.8f\n", row[0], exact.down, exact.back);
    EXPECT_NEAR(exact.down, row[1], 6e-6);
    EXPECT_NEAR(exact.back, row[2], 6e-6);
  }
}

TEST(Elastica, TipForceWithinOnePerCentAndOfSecondOrder) {
  for (const double load : {1.0, 2.0, 5.0, 10.0}) {
    const TipMotion exact = elastica(load);
    std::array<double, 3> error{};
    const std::array<std::size_t, 3> elements{10, 20, 40};
    for (std::size_t i = 0; i < 3; ++i) {
      const TipMotion tip = tipOf(elements[i], load);
      error[i] = std::hypot(tip.down - exact.down, tip.back - exact.back) / std::hypot(exact.down, exact.back);
      std::printf("load %4.1f, %2zu elements: w/L %.6f (exact %.6f) u/L %.6f (exact %.6f), error %.2e\n", load,
                  elements[i], tip.down, exact.down, tip.back, exact.back, error[i]);
    }
    EXPECT_LT(error[2], 0.001);
    EXPECT_LT(error[1], 0.01);
    EXPECT_NEAR(std::log2(error[0] / error[1]), 2.0, 0.2);
    EXPECT_NEAR(std::log2(error[1] / error[2]), 2.0, 0.2);
  }
}

}  // namespace
}  // namespace calot
