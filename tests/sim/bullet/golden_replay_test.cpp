// SPDX-License-Identifier: GPL-3.0-or-later
// Runs replay bit for bit with each broad phase: the golden that carries its samples, and what the grid recorded.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "recorder/replay.h"
#include "sim/bullet/bullet_tree.h"
#include "tests/recorder/support/performed_recording.h"

namespace calot::recorder {
namespace {

void expectExact(const std::filesystem::path& recording, MakeBroadPhase makeBroadPhase) {
  ReplaySettings settings;
  settings.engine.makeBroadPhase = makeBroadPhase;
  const ReplayReport report = replayRecording(recording, settings);
  EXPECT_EQ(report.verdict, ReplayVerdict::exact) << report.error;
}

TEST(GoldenReplay, IsExactByEachBroadPhase) {
  const std::filesystem::path golden = std::filesystem::path(CALOT_SOURCE_DIR) / "assets/golden/touch-liver.h5";
  expectExact(golden, nullptr);
  expectExact(golden, &BulletTree::make);
}

struct Performed {
  const char* scene;
  std::uint64_t seed;
  double seconds;
};

class PerformedReplay : public testing::TestWithParam<Performed> {};

TEST_P(PerformedReplay, IsExactByBulletsTrees) {
  const auto [scene, seed, seconds] = GetParam();
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / (std::string("by-grid-") + scene + ".h5");
  test::recordSkilled(file, scene, seed, seconds);
  expectExact(file, &BulletTree::make);
  std::filesystem::remove(file);
}

INSTANTIATE_TEST_SUITE_P(Scenes, PerformedReplay,
                         testing::Values(Performed{"clip-and-cut", 2, 0.0}, Performed{"carve-fat", 1, 8.0}));

}  // namespace
}  // namespace calot::recorder
