// SPDX-License-Identifier: GPL-3.0-or-later
// The whole way of a camera that is unplugged: pictures, device, loop, file, replay.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "recorder/formats/scene_file.h"
#include "recorder/live/worker_pool.h"
#include "recorder/loop.h"
#include "recorder/recording/writer.h"
#include "recorder/replay.h"
#include "recorder/sources/devices/camera/camera_device.h"
#include "recorder/sources/devices/device_source.h"
#include "sim/scene/model.h"
#include "tests/recorder/sources/devices/camera/support/marker_scene.h"

namespace calot::recorder {
namespace {

using namespace cameratest;

constexpr std::int64_t betweenPictures = 33'333'333;  // ns, as the times of the cable and of the last picture
constexpr std::int64_t unplugged = 300'000'000;
constexpr std::int64_t pluggedIn = 420'000'000;
constexpr std::int64_t lastPicture = 700'000'000;

/// A camera before both handles whose cable is out for a while: what it would have seen then is missing.
class UnpluggedCamera final : public FrameSource {
 public:
  UnpluggedCamera(RigCamera camera, std::shared_ptr<TickClock> clock)
      : FrameSource("camera", camera.lens.width, camera.lens.height, 30.0),
        camera_(std::move(camera)),
        clock_(std::move(clock)),
        begin_(clock_->now) {}

  FrameStatus next(std::chrono::nanoseconds, Frame& out) override {
    const std::int64_t now = clock_->now - begin_;
    if (now >= unplugged && now < pluggedIn) return FrameStatus::lost;
    std::uint64_t missed = 0;
    for (; now >= pluggedIn && time_ < pluggedIn; time_ += betweenPictures) ++missed;
    if (time_ >= lastPicture) return FrameStatus::ended;
    std::vector<Body> bodies;
    for (const Hand hand : {Hand::left, Hand::right})
      bodies.push_back(handleBody(hand, [hand](double t) { return handMotion(hand, t); }));
    Imaging quick;
    quick.samples = 2;
    out = {rendered(camera_, bodies, 1e-9 * static_cast<double>(time_), quick, random_), time_, missed};
    time_ += betweenPictures;
    return FrameStatus::frame;
  }

 private:
  RigCamera camera_;
  std::shared_ptr<TickClock> clock_;
  std::int64_t begin_ = 0, time_ = 0;
  Random random_{6};
};

class CameraRecording : public ::testing::TestWithParam<Mode> {};

TEST_P(CameraRecording, UnpluggedInMidRunLosesNothing) {
  const std::filesystem::path assets = std::filesystem::path(CALOT_SOURCE_DIR) / "assets";
  LoadedScene scene = loadScene(findScene("touch-liver", {assets}));
  const Model::Built built = Model::build(scene.description);
  ASSERT_TRUE(built.model) << built.error;
  const CameraRig rig = rigOfCameras(1);
  DeviceInfo info;
  info.name = "camera";
  info.identity = "camera:test";
  info.capabilities.realTime = false;
  info.capabilities.hands = 2;
  DeviceSourceSettings settings;
  settings.mode = GetParam();
  settings.tickClock = std::make_shared<TickClock>();
  std::vector<std::unique_ptr<FrameSource>> cameras;
  cameras.push_back(std::make_unique<UnpluggedCamera>(rig.cameras[0], settings.tickClock));
  auto device = std::make_unique<CameraDevice>(std::move(cameras), rig, info,
                                               [clock = settings.tickClock] { return clock->now; });
  DeviceSource source(std::move(device), built.model->scene(), settings);
  source.waitForFirst(1.0);
  AttemptSettings attempt;
  attempt.mode = GetParam();
  attempt.seed = 1;
  const AttemptHeader header = makeHeader(*built.model, std::move(scene.assets), source.provenance(), attempt);
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("calot-camera-recording-" + std::to_string(::getpid()) + ".h5");
  WorkerPool pool(1);
  RunReport report;
  {
    RecordingWriter writer(file, header, {true});
    Session session(*built.model, 1, pool);
    session.join(writer);
    report = runAttempt(session, source, RunSettings{});
    writer.finish();
  }
  if (GetParam() == Mode::assessment) {
    EXPECT_EQ(report.outcome, Outcome::technicalFailure);
    EXPECT_NEAR(static_cast<double>(report.steps), 30.0, 4.0);  // at the picture that did not come
  } else {
    EXPECT_EQ(report.outcome, Outcome::completed);
    EXPECT_EQ(report.pauses.count, 1U);
    EXPECT_GT(report.steps, 40U);  // it goes on afterwards
  }
  const ReplayReport replayed = replayRecording(file, ReplaySettings{});
  EXPECT_EQ(replayed.verdict, ReplayVerdict::exact) << replayed.error;
  EXPECT_TRUE(replayed.complete);
  EXPECT_EQ(replayed.outcome, report.outcome);
  EXPECT_EQ(replayed.steps, report.steps);
  std::filesystem::remove(file);
}

INSTANTIATE_TEST_SUITE_P(Modes, CameraRecording, ::testing::Values(Mode::practice, Mode::assessment),
                         [](const auto& which) { return which.param == Mode::practice ? "practice" : "assessment"; });

}  // namespace
}  // namespace calot::recorder
