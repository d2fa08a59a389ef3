// SPDX-License-Identifier: GPL-3.0-or-later
// The endoscope by keys, and by a device of its own.
#include <gtest/gtest.h>

#include <memory>

#include "recorder/sources/devices/device_script.h"
#include "recorder/sources/devices/scope_device.h"
#include "tests/recorder/sources/devices/support/device_support.h"

namespace calot::recorder {
namespace {

using devicetest::sampleAt;

const ScopeJoints begin{0.1, -0.1, 0.08, 0.0, 0.0};

ScopeJoints after(ScopeDriver& driver, int ticks) {
  ScopeJoints wish;
  for (int tick = 0; tick < ticks; ++tick) wish = driver.wish(tickLength * tick, begin, {});
  return wish;
}

TEST(ScopeKeysTest, MoveWhileTheyAreHeld) {
  auto input = std::make_shared<ScopeInput>();
  ScopeKeys keys(input);
  keys.setOut(begin);
  input->hold(ScopeControl::left, true);
  input->hold(ScopeControl::in, true);
  ScopeJoints wish = after(keys, 1000);
  EXPECT_NEAR(wish.pan, begin.pan - ScopeKeys::swingSpeed, 1e-9);
  EXPECT_NEAR(wish.insertion, begin.insertion + ScopeKeys::insertSpeed, 1e-9);
  input->hold(ScopeControl::right, true);
  input->hold(ScopeControl::in, false);
  wish = after(keys, 100);
  EXPECT_NEAR(wish.pan, begin.pan - ScopeKeys::swingSpeed, 1e-9) << "both ways at once is neither";
  input->release();
  input->move(10.0, 20.0);
  input->turnWheel(-1.0);
  wish = after(keys, 10);
  EXPECT_NEAR(wish.pan, begin.pan - ScopeKeys::swingSpeed + 10.0 * ScopeKeys::pixelSwing, 1e-9);
  EXPECT_NEAR(wish.tilt, begin.tilt - 20.0 * ScopeKeys::pixelSwing, 1e-9);
  EXPECT_NEAR(wish.insertion, begin.insertion + ScopeKeys::insertSpeed - ScopeKeys::notchInsert, 1e-9);
}

TEST(ScopeKeysTest, DropWhatCameInAPause) {
  auto input = std::make_shared<ScopeInput>();
  ScopeKeys keys(input);
  keys.setOut(begin);
  input->move(500.0, 0.0);
  keys.rest();
  EXPECT_EQ(after(keys, 1).pan, begin.pan);
}

/// A device whose script holds these samples of the right hand.
std::unique_ptr<ScopeDevice> deviceOf(const std::vector<DeviceSample>& samples, bool straight,
                                      const std::vector<DeviceScript::Unplugging>& unpluggings = {}) {
  DeviceScript script;
  script.name = "test";
  script.samples = samples;
  script.unpluggings = unpluggings;
  OpenedDevice opened;
  opened.tickClock = std::make_shared<TickClock>();
  opened.device = std::make_unique<ScriptedDevice>(script, [clock = opened.tickClock] { return clock->now; });
  auto device = std::make_unique<ScopeDevice>(std::move(opened), straight);
  device->setOut(begin);
  return device;
}

DeviceSample rolledAt(std::int64_t milliseconds, double roll) {
  DeviceSample s = sampleAt(milliseconds, Hand::right, Vec3::Zero());
  s.orientation = Quat(Eigen::AngleAxisd(roll, Vec3::UnitZ()));
  return s;
}

TEST(ScopeDeviceTest, MovesByWhatTheDeviceMovedSinceItWasFirstMeasured) {
  const auto device = deviceOf({sampleAt(0, Hand::right, Vec3(0.5, 0.5, 0.5)), sampleAt(50, Hand::left, Vec3::Zero()),
                                sampleAt(100, Hand::right, Vec3(0.51, 0.48, 0.53))},
                               true);
  EXPECT_EQ(after(*device, 50), begin) << "its frame begins where it was";
  const ScopeJoints wish = after(*device, 100);
  EXPECT_NEAR(wish.pan, begin.pan + 0.01 * ScopeDevice::swingOfMetre, 1e-9);
  EXPECT_NEAR(wish.tilt, begin.tilt + 0.02 * ScopeDevice::swingOfMetre, 1e-9) << "up";
  EXPECT_NEAR(wish.insertion, begin.insertion + 0.03, 1e-9);
  EXPECT_FALSE(device->realTime());
}

TEST(ScopeDeviceTest, RotatesTheCableOfAnAngledOpticAndTheHeadOfAStraightOne) {
  std::vector<DeviceSample> samples;
  for (int i = 0; i <= 40; ++i) samples.push_back(rolledAt(10 * i, 0.1 * i));  // past half a turn
  EXPECT_NEAR(after(*deviceOf(samples, false), 500).cable, 4.0, 1e-6);
  EXPECT_NEAR(after(*deviceOf(samples, false), 500).head, 0.0, 1e-9);
  EXPECT_NEAR(after(*deviceOf(samples, true), 500).head, 4.0, 1e-6);
}

TEST(ScopeDeviceTest, PedalsRotateTheHead) {
  DeviceSample pressed = sampleAt(0, Hand::right, Vec3::Zero());
  pressed.buttons = button::coagulatePedal;
  EXPECT_NEAR(after(*deviceOf({pressed}, false), 1000).head, ScopeDevice::headSpeed, 0.002);
}

TEST(ScopeDeviceTest, StandsStillWhileTheDeviceIsGoneAndGoesOnFromThere) {
  const auto device =
      deviceOf({sampleAt(0, Hand::right, Vec3::Zero()), sampleAt(100, Hand::right, Vec3(0.01, 0.0, 0.0)),
                sampleAt(200, Hand::right, Vec3(0.09, 0.0, 0.0)), sampleAt(300, Hand::right, Vec3(0.10, 0.0, 0.0))},
               true, {{150 * 1'000'000, 100 * 1'000'000}});
  const double gone = after(*device, 200).pan;
  EXPECT_NEAR(gone, begin.pan + 0.01 * ScopeDevice::swingOfMetre, 1e-9);
  EXPECT_NEAR(after(*device, 120).pan, gone, 1e-9) << "anchored anew where the device came back";
  EXPECT_NEAR(after(*device, 200).pan, gone + 0.01 * ScopeDevice::swingOfMetre, 1e-9);
}

}  // namespace
}  // namespace calot::recorder
