// SPDX-License-Identifier: GPL-3.0-or-later
// Against SDL's virtual joystick.
#include "recorder/sources/devices/pointer_device.h"

#include <gtest/gtest.h>

#include "recorder/base/errors.h"
#include "recorder/sources/devices/device_source.h"
#include "tests/recorder/sources/devices/support/device_support.h"
#include "tests/recorder/sources/devices/support/virtual_pad.h"

namespace calot::recorder {
namespace {

using devicetest::VirtualPad;

struct Rig {
  VirtualPad pad;
  std::int64_t now = 1'000'000'000;
  GamepadDevice device{"Calot test", [this] { return now; }};
  DeviceInput input;

  /// Lets so many milliseconds pass; the last sample.
  DeviceSample run(int milliseconds) {
    for (int i = 0; i < milliseconds; ++i) {
      now += 1'000'000;
      device.poll(std::chrono::nanoseconds(0), input);
    }
    return input.samples.empty() ? DeviceSample{} : input.samples.back();
  }
};

TEST(Gamepad, IsListedAndNamed) {
  Rig rig;
  const std::vector<ListedDevice> pads = listGamepads();
  EXPECT_TRUE(
      std::any_of(pads.begin(), pads.end(), [](const ListedDevice& d) { return d.detail == "Calot test pad"; }));
  EXPECT_EQ(rig.device.info().name, "gamepad");
  EXPECT_EQ(rig.device.info().identity, "gamepad:Calot test pad");
  EXPECT_EQ(rig.device.info().operatorKind, OperatorKind::human);
  EXPECT_THROW(GamepadDevice("no-such-pad"), Error);
}

TEST(Gamepad, SticksAndTriggersMoveAtTheirSpeeds) {
  Rig rig;
  EXPECT_EQ(rig.run(100).position, Vec3::Zero());
  rig.pad.set(SDL_CONTROLLER_AXIS_LEFTX, 32767);
  EXPECT_NEAR((rig.run(500).position - Vec3(0.030, 0, 0)).norm(), 0.0, 3e-4);
  rig.pad.set(SDL_CONTROLLER_AXIS_LEFTX, 3000);  // in the dead zone
  const Vec3 still = rig.run(8).position;
  EXPECT_EQ(rig.run(100).position, still);
  rig.pad.set(SDL_CONTROLLER_AXIS_LEFTX, 0);
  rig.pad.set(SDL_CONTROLLER_AXIS_LEFTY, 32767);
  rig.pad.set(SDL_CONTROLLER_AXIS_TRIGGERRIGHT, 32767);
  EXPECT_NEAR((rig.run(500).position - still - Vec3(0, 0.030, 0.030)).norm(), 0.0, 5e-4);
  rig.run(60000);
  EXPECT_LE(rig.input.samples.back().position.cwiseAbs().maxCoeff(), 0.15);
}

TEST(Gamepad, ButtonsRollJawAndPedals) {
  Rig rig;
  rig.pad.press(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER, true);
  rig.pad.press(SDL_CONTROLLER_BUTTON_DPAD_UP, true);
  rig.pad.press(SDL_CONTROLLER_BUTTON_A, true);
  const DeviceSample s = rig.run(400);
  EXPECT_NEAR(s.orientation.angularDistance(Quat(Eigen::AngleAxisd(0.6, Vec3::UnitZ()))), 0.0, 0.02);
  EXPECT_NEAR(s.gripper, 0.48, 0.02);
  EXPECT_EQ(s.buttons, button::fire);
  EXPECT_NEAR(rig.run(5000).gripper, 1.2, 1e-12);
}

TEST(Gamepad, OnePointerDrivesOneHandAndIsPassedOn) {
  const SceneDescription scene = devicetest::emptyScene();
  auto clock = std::make_shared<TickClock>();
  VirtualPad pad;
  DeviceSourceSettings settings;
  settings.tickClock = clock;
  DeviceSource source(std::make_unique<GamepadDevice>("Calot test", [clock] { return clock->now; }), scene, settings);
  source.waitForFirst(1.0);
  TickSamples tick;
  std::uint64_t i = 0;
  const auto run = [&](int ticks) {
    for (int k = 0; k < ticks; ++k) EXPECT_TRUE(source.next(i++, tick));
  };
  pad.set(SDL_CONTROLLER_AXIS_LEFTX, 32767);
  run(200);
  EXPECT_TRUE(tick.hand[1].valid);
  EXPECT_EQ(tick.hand[0].instrument, InstrumentKind::none);
  EXPECT_FALSE(tick.hand[0].valid);
  const Vec3 right = tick.hand[1].position;
  EXPECT_NEAR((right - scene.hands[1].home).norm(), 0.012, 5e-4);
  pad.press(SDL_CONTROLLER_BUTTON_START, true);
  run(10);
  pad.press(SDL_CONTROLLER_BUTTON_START, false);
  run(200);
  EXPECT_TRUE(tick.hand[0].valid);
  EXPECT_EQ(tick.hand[0].instrument, scene.hands[0].instrument);
  EXPECT_FALSE(tick.hand[1].valid);
  EXPECT_EQ(tick.hand[1].instrument, scene.hands[1].instrument);
  EXPECT_NEAR((tick.hand[1].position - right).norm(), 0.0, 5e-4);
}

TEST(Gamepad, ABranchActsOnlyWhenTheHandDoes) {
  const SceneDescription scene = devicetest::emptyScene();
  auto clock = std::make_shared<TickClock>();
  VirtualPad pad;
  pad.press(SDL_CONTROLLER_BUTTON_A, true);
  DeviceSourceSettings settings;
  settings.tickClock = clock;
  DeviceSource source(std::make_unique<GamepadDevice>("Calot test", [clock] { return clock->now; }), scene, settings);
  devicetest::expectNothingActs(source, scene);
  pad.press(SDL_CONTROLLER_BUTTON_DPAD_DOWN, true);
  TickSamples now;
  for (std::uint64_t tick = 5000; tick < 5100; ++tick) ASSERT_TRUE(source.next(tick, now));
  EXPECT_NEAR(now.hand[1].jaw, 0.75 - 0.12, 0.01);
}

TEST(Gamepad, PulledOutPausesAndComesBack) {
  auto clock = std::make_shared<TickClock>();
  VirtualPad pad;
  DeviceSourceSettings settings;
  settings.tickClock = clock;
  DeviceSource source(std::make_unique<GamepadDevice>("Calot test", [clock] { return clock->now; }),
                      devicetest::emptyScene(), settings);
  source.waitForFirst(1.0);
  TickSamples tick;
  std::uint64_t i = 0;
  pad.set(SDL_CONTROLLER_AXIS_LEFTX, 32767);
  for (; i < 100; ++i) ASSERT_TRUE(source.next(i, tick));
  const Vec3 before = tick.hand[1].position;
  pad.detach();
  for (; i < 110; ++i) ASSERT_TRUE(source.next(i, tick));
  EXPECT_FALSE(tick.hand[1].valid);
  EXPECT_EQ(source.status(), SourceStatus::paused);
  for (int k = 0; k < 700; ++k) EXPECT_EQ(source.status(), SourceStatus::paused);
  pad.attach();
  int waits = 0;
  while (source.status() == SourceStatus::paused && waits < 2000) ++waits;
  EXPECT_LE(waits, 600);
  for (; i < 120; ++i) ASSERT_TRUE(source.next(i, tick));
  EXPECT_TRUE(tick.hand[1].valid);
  EXPECT_LT((tick.hand[1].position - before).norm(), 1e-3);
  EXPECT_EQ(source.counts().losses, 1U);
}

TEST(Gamepad, PulledOutOfAnAssessmentFails) {
  auto clock = std::make_shared<TickClock>();
  VirtualPad pad;
  DeviceSourceSettings settings;
  settings.tickClock = clock;
  settings.mode = Mode::assessment;
  DeviceSource source(std::make_unique<GamepadDevice>("Calot test", [clock] { return clock->now; }),
                      devicetest::emptyScene(), settings);
  source.waitForFirst(1.0);
  TickSamples tick;
  ASSERT_TRUE(source.next(0, tick));
  EXPECT_EQ(source.status(), SourceStatus::ok);
  pad.detach();
  for (std::uint64_t i = 1; i < 10; ++i) ASSERT_TRUE(source.next(i, tick));
  EXPECT_EQ(source.status(), SourceStatus::failed);
}

}  // namespace
}  // namespace calot::recorder
