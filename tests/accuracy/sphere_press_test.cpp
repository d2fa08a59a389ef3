// SPDX-License-Identifier: GPL-3.0-or-later
// A probe with a round end of 2.5 mm pressed into a block, through the whole step: the force does not depend on the mesh
// and is that of the converged solution.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "sim/step/stepper.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

/// Force on a rigid sphere of 2.5 mm that is pressed into the middle of the block (N), by depth in mm: linear
/// elasticity, no friction, u_z >= the sphere's profile at rest. tests/accuracy/support/sphere_on_block.py, cells of
/// 0.25 mm under the sphere; half the cells change it by less than 1 %.
constexpr std::array<double, 7> reference{0.0, 0.01339, 0.03710, 0.06590, 0.09764, 0.13023, 0.16310};

/// Between the depths, as depth^1.3 times what changes slowly.
double referenceAt(double depth) {
  const double mm = 1e3 * depth;
  const auto at = static_cast<std::size_t>(std::clamp(std::floor(mm), 1.0, 5.0));
  const double low = static_cast<double>(at);
  const double a = reference[at] / std::pow(low, 1.3);
  const double b = reference[at + 1] / std::pow(low + 1.0, 1.3);
  return std::pow(mm, 1.3) * (a + (b - a) * (mm - low));
}

struct Pressed {
  double depth = 0.0;
  double force = 0.0;
  std::uint32_t rows = 0;
};

/// Presses in the middle of the block, at the given offset, and waits until all is still at each depth.
std::vector<Pressed> press(std::uint32_t tetrahedra, double x, double y, std::uint32_t ticks, int squares,
                           const std::vector<double>& depths, double friction) {
  SceneDescription scene = test::blockScene(tetrahedra, squares);
  scene.ticksPerStep = ticks;
  scene.hands[0].instrument = InstrumentKind::probe;
  scene.hands[0].port = Vec3(x, y, 0.13);
  scene.hands[0].couplingStiffness = 1e4;
  scene.hands[0].maxForce = 1e3;
  scene.organs[0].friction = friction;
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  SerialExecutor executor;
  State state = initialState(*model, 1);
  Stepper stepper(*model, executor);
  std::vector<Pressed> out;
  double from = -0.004;
  for (const double depth : depths) {
    StepResult result;
    const int ramp = static_cast<int>(400 / ticks);
    for (int i = 0; i < 12 * ramp; ++i) {
      const double now = from + (depth - from) * std::min(1.0, (i + 1.0) / ramp);
      std::vector<TickSamples> samples =
          test::ticksAt(scene, Vec3(x, y, test::blockTop - now), scene.hands[1].home);
      for (TickSamples& tick : samples) tick.hand[0].instrument = InstrumentKind::probe;
      result = stepper.step(state, samples);
      EXPECT_EQ(result.misses & ~miss::speed, 0U);
      if (i > ramp && result.organ[0].maxSpeed < 1e-6) break;
    }
    const HandResult& hand = result.hand[0];
    out.push_back({test::blockTop - hand.tipSimulated[2], hand.contactForce[2], result.contact.rows});
    from = depth;
  }
  return out;
}

TEST(SpherePress, ForceIsThatOfTheConvergedSolution) {
  for (const std::uint32_t tetrahedra : getenv("ONE") ? std::vector<std::uint32_t>{static_cast<std::uint32_t>(atoi(getenv("ONE")))} : std::vector<std::uint32_t>{300U, 1200U, 4800U, 20000U}) {
    for (const auto& [x, y] : {std::pair{0.0003, 0.0002}, std::pair{0.0019, 0.0017}, std::pair{0.0041, 0.0002}}) {
      double worst = 0.0;
      std::printf("%u at (%.1f, %.1f) mm:", tetrahedra, 1e3 * x, 1e3 * y);
      for (const Pressed& p : press(tetrahedra, x, y, 10, 16, {0.001, 0.002, 0.003, 0.004, 0.005, 0.006}, 0.0)) {
        const double off = p.force / referenceAt(p.depth) - 1.0;
        std::printf("  %.2f mm %.4f N %+.1f %% (%u)", 1e3 * p.depth, p.force, 100.0 * off, p.rows);
        worst = std::max(worst, std::abs(off));
      }
      std::printf("\n");
      EXPECT_LT(worst, 0.10);
    }
  }
}

}  // namespace
}  // namespace calot
