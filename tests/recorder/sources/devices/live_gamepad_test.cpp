// SPDX-License-Identifier: GPL-3.0-or-later
// A gamepad that drives a run of two loops: recorded, unplugged in mid-run, replayed.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "recorder/formats/scene_file.h"
#include "recorder/live/worker_pool.h"
#include "recorder/loop.h"
#include "recorder/recording/reader.h"
#include "recorder/recording/recording_facts.h"
#include "recorder/recording/writer.h"
#include "recorder/replay.h"
#include "recorder/sources/devices/device_source.h"
#include "recorder/sources/devices/pointer_device.h"
#include "tests/recorder/sources/devices/support/virtual_pad.h"

namespace calot::recorder {
namespace {

class LiveGamepad : public ::testing::TestWithParam<Mode> {
 protected:
  LiveGamepad() : built_(Model::build(scene_.description)) {}
  ~LiveGamepad() override {
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
  }
  LiveGamepad(const LiveGamepad&) = delete;
  LiveGamepad& operator=(const LiveGamepad&) = delete;

  LoadedScene scene_ = loadScene(findScene("touch-liver", {std::filesystem::path(CALOT_SOURCE_DIR) / "assets"}));
  Model::Built built_;
  std::filesystem::path file_ =
      std::filesystem::temp_directory_path() / ("calot-gamepad-" + std::to_string(getpid()) + ".h5");
};

TEST_P(LiveGamepad, PulledOutInMidRunLosesNothing) {
  ASSERT_TRUE(built_.model) << built_.error;
  devicetest::VirtualPad pad;
  DeviceSourceSettings settings;
  settings.mode = GetParam();
  DeviceSource source(std::make_unique<GamepadDevice>("Calot test"), built_.model->scene(), settings);
  source.waitForFirst(10.0);
  AttemptSettings attempt;
  attempt.mode = GetParam();
  attempt.seed = 1;
  const AttemptHeader header = makeHeader(*built_.model, std::move(scene_.assets), source.provenance(), attempt);
  ASSERT_TRUE(header.deviceSamples);
  WorkerPool pool(1);
  RunReport report;
  std::thread person;  // who plugs it in again
  {
    RecordingWriter writer(file_, header, {true});
    writer.takeRawSamples(source.rawSamples());
    Session session(*built_.model, 1, pool);
    session.join(writer);
    RunSettings run;
    run.live = true;
    run.seconds = 1.5;
    run.progress = [&](std::uint64_t step) {
      if (step == 20) pad.set(SDL_CONTROLLER_AXIS_LEFTX, 32767);
      if (step != 80) return;
      pad.detach();
      if (GetParam() == Mode::practice) {
        person = std::thread([&pad] {
          std::this_thread::sleep_for(std::chrono::milliseconds(300));
          pad.attach();
        });
      }
    };
    report = runAttempt(session, source, run);
    writer.finish();
  }
  if (person.joinable()) person.join();
  EXPECT_EQ(report.disagreements, 0U);
  if (GetParam() == Mode::practice) {
    EXPECT_EQ(report.outcome, Outcome::stopped);
    EXPECT_EQ(report.steps, 150U);
    EXPECT_EQ(report.pauses.count, 1U);
  } else {
    EXPECT_EQ(report.outcome, Outcome::technicalFailure);
    EXPECT_GE(report.steps, 80U);
    EXPECT_LT(report.steps, 150U);
  }
  const ReplayReport replayed = replayRecording(file_, ReplaySettings{});
  EXPECT_EQ(replayed.verdict, ReplayVerdict::exact) << replayed.error;
  EXPECT_TRUE(replayed.complete);
  EXPECT_EQ(replayed.outcome, report.outcome);

  Recording recording(file_);
  const RawStatistics right = rawStatistics(recording, Hand::right);
  EXPECT_GT(right.samples, 20U);
  EXPECT_EQ(right.missing, 0U);
  EXPECT_EQ(right.dropped, 0U);
  EXPECT_EQ(recording.rawSampleCount(Hand::left), 0U);  // one pointer, one hand
  // A tick that used a sample is where that sample says: D and W differ by the anchor and the camera's turn alone.
  const std::vector<RawSample> raw = recording.rawSamples(Hand::right, 0, right.samples);
  const Quat& camera = built_.model->scene().camera.orientation;
  const Vec3 home = recording.step(0).samples[0].hand[1].position;
  double farthest = 0.0;
  for (const RawSample& r : raw) {
    if (!r.used || r.tick >= 700) continue;
    const std::uint64_t step = r.tick / 10;
    const Vec3 at = recording.step(step).samples[r.tick % 10].hand[1].position;
    EXPECT_LT((at - home - camera * (r.sample.position - raw.front().sample.position)).norm(), 4e-6);
    farthest = std::max(farthest, (at - home).norm());
  }
  EXPECT_GT(farthest, 0.005);
}

INSTANTIATE_TEST_SUITE_P(Modes, LiveGamepad, ::testing::Values(Mode::practice, Mode::assessment),
                         [](const auto& which) { return which.param == Mode::practice ? "practice" : "assessment"; });

}  // namespace
}  // namespace calot::recorder
