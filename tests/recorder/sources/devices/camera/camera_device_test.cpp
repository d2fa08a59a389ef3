// SPDX-License-Identifier: GPL-3.0-or-later
// The device over rendered pictures: what it believes, what it says of missing frames, and its unplugging.
#include "recorder/sources/devices/camera/camera_device.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/input.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <deque>
#include <filesystem>

#include "recorder/base/errors.h"
#include "recorder/sources/devices/calibration.h"
#include "recorder/sources/devices/open_device.h"
#include "tests/recorder/sources/devices/camera/support/film_of_scene.h"
#include "tests/recorder/sources/devices/camera/support/marker_scene.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

using namespace cameratest;

constexpr std::int64_t frameTime = 33'333'333;

/// Frames that a test has made; each is an event, so that losses can be played.
class PlayedSource final : public FrameSource {
 public:
  struct Item {
    FrameStatus status = FrameStatus::frame;
    Frame frame;
  };
  explicit PlayedSource(std::deque<Item> items) : FrameSource("played", 1280, 720, 30.0), items_(std::move(items)) {}
  FrameStatus next(std::chrono::nanoseconds, Frame& out) override {
    if (items_.empty()) return FrameStatus::ended;
    const Item item = std::move(items_.front());
    items_.pop_front();
    if (item.status == FrameStatus::frame) out = item.frame;
    return item.status;
  }

 private:
  std::deque<Item> items_;
};

GreyImage pictureAt(const RigCamera& camera, double time, const std::function<double(double)>& jaw, Random& random,
                    const std::optional<Occluder>& occluder = std::nullopt) {
  std::vector<Body> bodies;
  for (const Hand hand : {Hand::left, Hand::right}) {
    // The flap is beside the face that looks at the camera.
    const Quat turned = rotationBy(jaw ? Vec3(0.0, 0.9, 0.0) : Vec3::Zero());
    bodies.push_back(handleBody(hand, [hand, turned](double t) {
      const Pose pose = handMotion(hand, t);
      return Pose{pose.position, turned * pose.orientation};
    }));
    if (jaw) bodies.back().flap = [hand, jaw](double t) { return flapAt(hand, jaw(t)); };
  }
  Imaging quick;
  quick.samples = 2;
  return rendered(camera, bodies, time, quick, random, occluder);
}

DeviceInfo filmInfo() {
  DeviceInfo info;
  info.name = "camera";
  info.identity = "camera:film";
  info.capabilities.realTime = false;
  info.capabilities.hands = 2;
  return info;
}

struct Played {
  std::vector<DeviceSample> samples;
  std::vector<DeviceEvent> events;
};

Played played(std::vector<std::deque<PlayedSource::Item>> films, const CameraRig& rig) {
  std::vector<std::unique_ptr<FrameSource>> sources;
  for (auto& film : films) sources.push_back(std::make_unique<PlayedSource>(std::move(film)));
  std::int64_t now = 0;
  CameraDevice device(std::move(sources), rig, filmInfo(), [&now] { return now; });
  Played out;
  DeviceInput input;
  for (int i = 0; i < 10000 && !device.ended(); ++i, now += 10'000'000) device.poll(std::chrono::nanoseconds(0), input);
  EXPECT_TRUE(device.ended());
  out.samples = input.samples;
  out.events = input.events;
  return out;
}

TEST(CameraDevice, MissingFramesAreToldAndNumbered) {
  const CameraRig rig = rigOfCameras(1);
  Random random(1);
  std::deque<PlayedSource::Item> film;
  for (const int i : {0, 1, 4}) {
    Frame frame{pictureAt(rig.cameras[0], 0.033 * i, nullptr, random), i * frameTime, i == 4 ? 2U : 0U};
    film.push_back({FrameStatus::frame, frame});
  }
  const Played p = played({film}, rig);
  ASSERT_EQ(p.samples.size(), 6U);
  EXPECT_EQ(p.samples[0].sequence, 0U);
  EXPECT_EQ(p.samples[2].sequence, 1U);
  EXPECT_EQ(p.samples[4].sequence, 4U);
  EXPECT_EQ(p.samples[5].hand, Hand::right);
  EXPECT_TRUE(std::any_of(p.events.begin(), p.events.end(), [](const DeviceEvent& e) {
    return holdsToken(e.text, "2") && holdsToken(e.text, "0.133 s");
  }));
  for (const DeviceSample& s : p.samples) EXPECT_TRUE(s.valid) << static_cast<int>(s.hand) << " " << s.sequence;
}

TEST(CameraDevice, WhatIsHiddenIsNotMeasuredAndTheOtherHandIs) {
  const CameraRig rig = rigOfCameras(1);
  Random random(2);
  std::deque<PlayedSource::Item> film;
  for (int i = 0; i < 3; ++i) {
    std::optional<Occluder> hidden;
    if (i > 0) hidden = Occluder{640.0, 0.0, 1280.0, 720.0};
    film.push_back(
        {FrameStatus::frame, {pictureAt(rig.cameras[0], 0.033 * i, nullptr, random, hidden), i * frameTime, 0}});
  }
  const Played p = played({film}, rig);
  ASSERT_EQ(p.samples.size(), 6U);
  for (const DeviceSample& s : p.samples) EXPECT_EQ(s.valid, s.hand == Hand::left || s.sequence == 0) << s.sequence;
}

TEST(CameraDevice, TheFlapIsTheJaw) {
  const CameraRig rig = rigOfCameras(2);
  Random random(3);
  const auto jaw = [](double t) { return 0.2 + 4.0 * t; };
  std::vector<std::deque<PlayedSource::Item>> films(2);
  for (int i = 0; i < 4; ++i) {
    for (std::size_t c = 0; c < 2; ++c)
      films[c].push_back(
          {FrameStatus::frame,
           {pictureAt(rig.cameras[c], 1e-9 * static_cast<double>(i * frameTime), jaw, random), i * frameTime, 0}});
  }
  const Played p = played(films, rig);
  ASSERT_EQ(p.samples.size(), 8U);
  int seen = 0;
  for (const DeviceSample& s : p.samples) {
    if (!s.valid || s.gripper == 0.0) continue;
    ++seen;
    EXPECT_NEAR(s.gripper, jaw(1e-9 * static_cast<double>(s.deviceTime)), 0.06) << s.sequence;
  }
  EXPECT_GE(seen, 3);
}

TEST(CameraDevice, UnpluggingIsAnEventAndItComesBack) {
  const CameraRig rig = rigOfCameras(1);
  Random random(4);
  std::deque<PlayedSource::Item> film;
  film.push_back({FrameStatus::frame, {pictureAt(rig.cameras[0], 0.0, nullptr, random), 0, 0}});
  film.push_back({FrameStatus::lost, {}});
  film.push_back({FrameStatus::lost, {}});
  film.push_back({FrameStatus::frame, {pictureAt(rig.cameras[0], 0.2, nullptr, random), 6 * frameTime, 0}});
  const Played p = played({film}, rig);
  std::vector<DeviceEvent::Kind> kinds;
  for (const DeviceEvent& e : p.events) {
    if (e.kind != DeviceEvent::Kind::status) kinds.push_back(e.kind);
  }
  EXPECT_EQ(kinds,
            (std::vector{DeviceEvent::Kind::connected, DeviceEvent::Kind::disconnected, DeviceEvent::Kind::connected}));
  EXPECT_EQ(p.samples.size(), 4U);
}

TEST(CameraDevice, AFilmGivesTheSameSamplesEveryTime) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("calot-camera-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const std::string file = (folder / "hands.y4m").string();
  Calibration calibration;
  calibration.identity = "camera:film";
  calibration.device = "camera";
  calibration.camera = rigOfCameras(1);
  Random random(5);
  {
    PlainFilm film(file, 1280, 720, 30);
    for (int i = 0; i < 3; ++i) film.add(pictureAt(calibration.camera->cameras[0], i / 30.0, nullptr, random));
  }
  std::vector<DeviceInput> runs(2);
  for (DeviceInput& run : runs) {
    const OpenedDevice opened = openDevice("camera:" + file, {"", ""}, &calibration);
    ASSERT_TRUE(opened.tickClock);
    EXPECT_EQ(opened.device->info().sourceFile, "hands.y4m");
    EXPECT_EQ(opened.device->info().sourceSha256.size(), 64U);
    EXPECT_EQ(opened.device->info().identity, "camera:film");
    for (; !opened.device->ended(); opened.tickClock->now += 1'000'000)
      opened.device->poll(std::chrono::nanoseconds(0), run);
  }
  ASSERT_EQ(runs[0].samples.size(), 6U);
  ASSERT_EQ(runs[1].samples.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(runs[0].samples[i].position, runs[1].samples[i].position);
    EXPECT_EQ(runs[0].samples[i].orientation.coeffs(), runs[1].samples[i].orientation.coeffs());
    EXPECT_EQ(runs[0].samples[i].hostTime, runs[1].samples[i].hostTime);
  }
  // Cut off in the middle of a frame, and no film at all.
  std::filesystem::resize_file(file, 1280 * 720 * 2);
  const OpenedDevice cut = openDevice("camera:" + file, {"", ""}, &calibration);
  DeviceInput rest;
  for (int i = 0; i < 1000 && !cut.device->ended(); ++i, cut.tickClock->now += 1'000'000)
    cut.device->poll(std::chrono::nanoseconds(0), rest);
  EXPECT_TRUE(cut.device->ended());
  EXPECT_LE(rest.samples.size(), 4U);
  const auto refused = [](ErrorKind kind, const std::string& value, const std::vector<Remedy>& remedies,
                          const std::string& name, const Calibration* with) {
    SCOPED_TRACE(name);
    expectFault(
        kind, "", {value},
        [&] {
          openDevice(name, {"", ""}, with);
        },
        remedies);
  };
  refused(ErrorKind::invalid, "device", {Remedy::measureCalibration}, "camera:" + file, nullptr);
  refused(ErrorKind::invalid, "2 cameras", {Remedy::nameDevice}, "camera:" + file + ",other.y4m", &calibration);
  refused(ErrorKind::damaged, "nowhere.y4m", {}, "camera:/nowhere.y4m", &calibration);
  refused(ErrorKind::invalid, "\"camera\"", {Remedy::nameDevice}, "camera", &calibration);
  refused(ErrorKind::invalid, "device", {Remedy::nameDevice}, "camera:0," + file, &calibration);
  refused(ErrorKind::failure, "/dev/video987", {}, "camera:/dev/video987", &calibration);
  std::filesystem::resize_file(file, 40);
  refused(ErrorKind::damaged, "hands.y4m", {}, "camera:" + file, &calibration);
  calibration.camera->cameras[0].lens.width = 640;
  std::filesystem::remove_all(folder);
}

TEST(PedalKeys, KeysAreHeldUntilTheyGoUpOrTheKeyboardGoes) {
  const std::string file = std::filesystem::temp_directory_path() / ("calot-keys-" + std::to_string(::getpid()));
  ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
  PedalKeys keys(file);
  const int out = ::open(file.c_str(), O_WRONLY);
  ASSERT_GE(out, 0);
  const auto press = [&](int code, int value) {
    input_event event{};
    event.type = EV_KEY;
    event.code = static_cast<std::uint16_t>(code);
    event.value = value;
    ASSERT_EQ(::write(out, &event, sizeof event), static_cast<ssize_t>(sizeof event));
  };
  press(KEY_F1, 1);
  press(KEY_P, 1);
  press(KEY_Z, 1);
  EXPECT_TRUE(keys.read());
  EXPECT_EQ(keys.hold(Hand::right).buttons, button::cutPedal);
  EXPECT_GT(keys.hold(Hand::right).jawRate, 0.0);
  EXPECT_EQ(keys.hold(Hand::left).buttons, button::cutPedal);
  press(KEY_F1, 0);
  press(KEY_DOT, 1);
  EXPECT_TRUE(keys.read());
  EXPECT_EQ(keys.hold(Hand::right).buttons, button::coagulatePedal);
  ::close(out);
  EXPECT_FALSE(keys.read());
  EXPECT_EQ(keys.hold(Hand::right).buttons, 0);
  EXPECT_EQ(keys.hold(Hand::right).jawRate, 0.0);
  std::filesystem::remove(file);
  EXPECT_THROW(PedalKeys("/nowhere/keyboard"), Error);
}

}  // namespace
}  // namespace calot::recorder
