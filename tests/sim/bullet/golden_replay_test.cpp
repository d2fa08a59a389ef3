// SPDX-License-Identifier: GPL-3.0-or-later
// Golden recordings replay bit for bit with each broad phase.
#include <gtest/gtest.h>

#include <filesystem>

#include "recorder/replay.h"
#include "sim/bullet/bullet_tree.h"

namespace calot::recorder {
namespace {

class GoldenReplay : public testing::TestWithParam<const char*> {
 protected:
  static void expectExact(MakeBroadPhase makeBroadPhase) {
    ReplaySettings settings;
    settings.engine.makeBroadPhase = makeBroadPhase;
    const std::filesystem::path golden = std::filesystem::path(CALOT_SOURCE_DIR) / "assets/golden" / GetParam();
    const ReplayReport report = replayRecording(golden, settings);
    EXPECT_EQ(report.verdict, ReplayVerdict::exact) << report.error;
  }
};

TEST_P(GoldenReplay, IsExactByTheGrid) { expectExact(nullptr); }
TEST_P(GoldenReplay, IsExactByBulletsTrees) { expectExact(&BulletTree::make); }

INSTANTIATE_TEST_SUITE_P(BroadPhases, GoldenReplay,
                         testing::Values("touch-liver.h5", "clip-and-cut.h5", "carve-fat.h5"));

}  // namespace
}  // namespace calot::recorder
