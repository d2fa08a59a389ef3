// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings replay bit for bit with each broad phase: the golden that carries its samples, and performers' runs.
#include <gtest/gtest.h>

#include <filesystem>

#include "recorder/replay.h"
#include "sim/bullet/bullet_tree.h"
#include "tests/recorder/support/performed_recording.h"

namespace calot::recorder {
namespace {

struct Case {
  const char* scene;
  std::uint64_t seed;
  double seconds;  ///< of the recording; negative: the golden recording of that name
};

class GoldenReplay : public testing::TestWithParam<Case> {
 protected:
  static void expectExact(MakeBroadPhase makeBroadPhase) {
    const auto [scene, seed, seconds] = GetParam();
    std::filesystem::path file = std::filesystem::path(CALOT_SOURCE_DIR) / "assets/golden" / (std::string(scene) + ".h5");
    if (seconds >= 0.0) {
      file = std::filesystem::path(testing::TempDir()) / (std::string("broad-phases-") + scene + ".h5");
      test::recordSkilled(file, scene, seed, seconds);
    }
    ReplaySettings settings;
    settings.engine.makeBroadPhase = makeBroadPhase;
    const ReplayReport report = replayRecording(file, settings);
    EXPECT_EQ(report.verdict, ReplayVerdict::exact) << report.error;
    if (seconds >= 0.0) std::filesystem::remove(file);
  }
};

TEST_P(GoldenReplay, IsExactByTheGrid) { expectExact(nullptr); }
TEST_P(GoldenReplay, IsExactByBulletsTrees) { expectExact(&BulletTree::make); }

INSTANTIATE_TEST_SUITE_P(BroadPhases, GoldenReplay,
                         testing::Values(Case{"touch-liver", 1, -1.0}, Case{"clip-and-cut", 2, 0.0},
                                         Case{"carve-fat", 1, 8.0}));

}  // namespace
}  // namespace calot::recorder
