// SPDX-License-Identifier: GPL-3.0-or-later
// Whole steps of 1 to 100 ms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "tests/sim/scene/support/loop.h"

namespace calot {
namespace {

/// Up to 50 ms the largest force is that of a step of 1 ms; longer ones miss the deepest moment.
/// A hand presses 6 mm deep within 0.2 s, slides, lets go, and the block is left alone for 3 s.
TEST(AnyStep, PressedAndLetGo) {
  double finest = 0.0;  // force with steps of 1 ms (N)
  for (const std::uint32_t ticks : {1U, 5U, 20U, 50U, 100U}) {
    SceneDescription scene = test::blockScene(300, 8);
    scene.ticksPerStep = ticks;
    const std::unique_ptr<const Model> model = test::buildModel(scene);
    ASSERT_TRUE(model);
    test::Loop loop(*model);
    const auto sample = [&](double t) {
      TickSamples tick = loop.resting();
      const double down = std::clamp(std::min(t / 0.2, 5.0 * (1.0 - t)), 0.0, 1.0);
      tick.hand[0].position =
          Vec3(-0.012 + 0.01 * std::min(t, 1.0), 0.002, 0.03 - down * (0.03 - test::blockTop + 0.006));
      return tick;
    };
    double force = 0.0;
    double depth = 0.0;
    int missed = 0;
    const int steps = static_cast<int>(4000U / ticks);
    for (int i = 0; i < steps; ++i) {
      const StepResult& result = loop.step(sample, [] {});
      ASSERT_TRUE(test::allFinite(loop.rig.state)) << ticks << " ms, step " << i;
      ASSERT_EQ(result.misses & miss::runaway, 0U);
      EXPECT_EQ((result.misses & miss::contact) != 0, result.contact.residual > scene.solver.contactTolerance);
      force = std::max(force, result.hand[0].contactForce.norm());
      depth = std::max(depth, result.contact.maxDepth);
      missed += result.misses != 0 ? 1 : 0;
    }
    std::printf("steps of %u ms: at most %.3f N, %.3f mm deep, %d of %d missed a tolerance; %.2e mm from rest\n", ticks,
                force, 1e3 * depth, missed, steps, 1e3 * loop.rig.state.organ[0].maxDisplacement);
    if (ticks == 1) finest = force;
    EXPECT_NEAR(force, finest, (ticks <= 50 ? 0.05 : 0.3) * finest);
    EXPECT_LT(depth, 2e-5);
    EXPECT_EQ(missed, 0);
    EXPECT_LT(loop.rig.state.organ[0].maxDisplacement, 2e-6) << "it is back at rest";
  }
}

}  // namespace
}  // namespace calot
