// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/device_script.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/recorder/sources/devices/support/device_support.h"

namespace calot::recorder {
namespace {

TEST(WrenchGate, KeepsDirectionAndShortensToWhatTheDeviceCanDo) {
  WrenchGate gate(8.0, 0.1);
  gate.command({Vec3(3, 0, 4), Vec3(0, 0.05, 0)}, 0);
  EXPECT_EQ(gate.output(1).force, Vec3(3, 0, 4));
  EXPECT_EQ(gate.output(1).torque, Vec3(0, 0.05, 0));
  gate.command({Vec3(30, 0, 40), Vec3(0, -5, 0)}, 0);
  EXPECT_NEAR((gate.output(1).force - Vec3(4.8, 0, 6.4)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((gate.output(1).torque - Vec3(0, -0.1, 0)).norm(), 0.0, 1e-12);
}

TEST(WrenchGate, HugeAndSenselessCommandsStayBounded) {
  WrenchGate gate(8.0, 0.1);
  gate.command({Vec3(1e300, 1e300, 0), Vec3::Zero()}, 0);
  EXPECT_NEAR(gate.output(1).force.norm(), 8.0, 1e-9);
  gate.command({Vec3(1e-320, 0, 0), Vec3::Zero()}, 0);
  EXPECT_TRUE(gate.output(1).force.allFinite());
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    gate.command({Vec3(bad, 1, 1), Vec3(0, bad, 0)}, 0);
    EXPECT_EQ(gate.output(1).force, Vec3::Zero());
    EXPECT_EQ(gate.output(1).torque, Vec3::Zero());
  }
}

TEST(WrenchGate, LetsGoWhenNobodyRenewsTheCommand) {
  WrenchGate gate(8.0, 0.1);
  EXPECT_EQ(gate.output(0).force, Vec3::Zero());
  gate.command({Vec3(1, 2, 2), Vec3::Zero()}, 1'000'000);
  EXPECT_EQ(gate.output(1'000'000 + WrenchGate::watchdog - 1).force, Vec3(1, 2, 2));
  EXPECT_EQ(gate.output(1'000'000 + WrenchGate::watchdog).force, Vec3::Zero());
  gate.command({Vec3(1, 2, 2), Vec3::Zero()}, 200'000'000);
  EXPECT_EQ(gate.output(200'000'001).force, Vec3(1, 2, 2));
}

TEST(WrenchGate, ScriptedMotorsShowNothingWhileUnplugged) {
  std::int64_t now = 0;
  DeviceScript script = devicetest::movingScript(100, 1, {Hand::right});
  script.maxForce = 5.0;
  script.unpluggings.push_back({10'000'000, 5'000'000});
  ScriptedDevice device(script, [&] { return now; });
  DeviceInput input;
  device.poll(std::chrono::nanoseconds(0), input);
  device.setWrench(Hand::right, {Vec3(0, 0, 9), Vec3::Zero()});
  EXPECT_NEAR(device.shown(Hand::right).force.z(), 5.0, 1e-12);
  EXPECT_EQ(device.shown(Hand::left).force, Vec3::Zero());
  now = 11'000'000;
  device.poll(std::chrono::nanoseconds(0), input);
  ASSERT_FALSE(device.connected());
  EXPECT_EQ(device.shown(Hand::right).force, Vec3::Zero());
}

}  // namespace
}  // namespace calot::recorder
