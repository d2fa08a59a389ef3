// SPDX-License-Identifier: GPL-3.0-or-later
// A simulation that runs away ends the attempt, says so, and leaves a recording that replays to that step.
#include <gtest/gtest.h>

#include <string>

#include "recorder/loop.h"
#include "recorder/recording/writer.h"
#include "recorder/replay.h"
#include "tests/recorder/support/small_scene.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

/// The small scene with a weight, and nothing that holds the gallbladder: it falls away from the liver.
test::SmallScene fallingScene() {
  test::SmallScene scene = test::smallScene();
  std::vector<std::byte>& bytes = scene.assets[0].bytes;
  std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto put = [&text](const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  };
  put(R"("gravity": [0, -9.218, -3.355])", R"("gravity": [0, 0, -20], "solver": {"sleeping": false})");
  put(R"([{"nearOrgan": {"organ": "liver", "distance": 0.004}}])", "[]");
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  bytes.assign(first, first + text.size());
  Model::Built built = Model::build(sceneFromAssets(scene.assets).description);
  EXPECT_TRUE(built.model) << built.error;
  scene.model = std::move(built.model);
  return scene;
}

void expectTold(const RunReport& report) {
  EXPECT_EQ(report.outcome, Outcome::technicalFailure);
  EXPECT_GE(report.steps, 149U) << "30 m/s at 20 m/s^2 take 1.5 s";
  ASSERT_TRUE(report.runaway);
  EXPECT_EQ(report.runaway->structure, "gallbladder");
}

TEST(Runaway, EndsTheAttemptAsATechnicalFailure) {
  const test::Folder folder;
  const test::SmallScene scene = fallingScene();
  const auto source = test::performer(scene, "skilled", 1, 0);
  const std::filesystem::path file = folder / "fall.h5";
  RecordingWriter writer(file, makeHeader(*scene.model, scene.assets, source->provenance(), {}));
  SerialExecutor executor;
  Session session(*scene.model, 0, executor);
  session.join(writer);
  RunSettings settings;
  settings.seconds = 20.0;
  const RunReport report = runAttempt(session, *source, settings);
  writer.finish();
  expectTold(report);
  EXPECT_LE(report.steps, 152U);
  const ReplayReport replayed = replayRecording(file, {});
  EXPECT_EQ(replayed.verdict, ReplayVerdict::exact) << replayed.error;
  EXPECT_EQ(replayed.outcome, Outcome::technicalFailure);
  EXPECT_EQ(replayed.steps, report.steps);
}

/// The ticks may be ahead of a slow machine's steps, which are all taken.
TEST(Runaway, EndsALiveAttemptToo) {
  const test::SmallScene scene = fallingScene();
  const auto source = test::performer(scene, "skilled", 1, 0);
  SerialExecutor executor;
  Session session(*scene.model, 0, executor);
  RunSettings settings;
  settings.live = settings.paced = true;
  settings.seconds = 20.0;
  const RunReport report = runAttempt(session, *source, settings);
  expectTold(report);
  EXPECT_LT(report.steps, 400U);
}

}  // namespace
}  // namespace calot::recorder
