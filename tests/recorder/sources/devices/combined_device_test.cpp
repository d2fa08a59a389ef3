// SPDX-License-Identifier: GPL-3.0-or-later
// Two devices, one for each hand.
#include "recorder/sources/devices/open_device.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "recorder/sources/devices/device_script.h"
#include "recorder/sources/devices/device_source.h"
#include "recorder/sources/devices/mouse_device.h"
#include "tests/recorder/sources/devices/support/device_support.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

const std::array<std::string, handCount> combinedTools{"LeftTool", "RightTool"};

OpenedDevice scripted(const DeviceScript& script) {
  auto ticks = std::make_shared<TickClock>();
  return {std::make_unique<ScriptedDevice>(script, [ticks] { return ticks->now; }), ticks};
}

TEST(CombinedDevice, EachDrivesItsOwnHandAndBothMustBeThere) {
  // Both scripts have both hands; the left one is unplugged at 50 ms for 30.
  DeviceScript left = devicetest::movingScript(200, 1, {Hand::left, Hand::right});
  left.unpluggings.push_back({50'000'000, 30'000'000});
  DeviceScript right = devicetest::movingScript(200, 2, {Hand::left, Hand::right});
  for (DeviceSample& s : right.samples) s.position = -s.position;
  auto clock = std::make_shared<TickClock>();
  CombinedDevice device({scripted(left), scripted(right)}, clock);
  EXPECT_EQ(device.info().capabilities.hands, 2);
  EXPECT_FALSE(device.info().capabilities.realTime);
  EXPECT_EQ(device.info().name, "scripted+scripted");
  DeviceInput input;
  for (clock->now = 0; clock->now < 300'000'000; clock->now += 1'000'000)
    device.poll(std::chrono::nanoseconds(0), input);
  std::array<std::size_t, handCount> count{};
  for (const DeviceSample& s : input.samples) {
    ++count[static_cast<std::size_t>(s.hand)];
    EXPECT_EQ(s.position.x() >= 0.0, s.hand == Hand::left || s.position.x() == 0.0);
  }
  EXPECT_EQ(count[0], 200U);
  EXPECT_EQ(count[1], 100U);
  std::vector<DeviceEvent::Kind> kinds;
  for (const DeviceEvent& e : input.events) kinds.push_back(e.kind);
  using Kind = DeviceEvent::Kind;
  EXPECT_EQ(kinds, (std::vector<Kind>{Kind::status, Kind::connected, Kind::disconnected, Kind::connected}));
  EXPECT_TRUE(input.events[2].text.starts_with("left: "));
  EXPECT_TRUE(device.ended());
}

TEST(CombinedDevice, BothSetOutFromWhereTheyWere) {
  const SceneDescription scene = devicetest::emptyScene();
  std::array<OpenedDevice, handCount> mice;
  for (std::size_t h = 0; h < handCount; ++h) {
    auto ticks = std::make_shared<TickClock>();
    mice[h] = {std::make_unique<MouseDevice>(std::make_shared<MouseInput>(), [ticks] { return ticks->now; }), ticks};
  }
  DeviceSourceSettings settings;
  settings.tickClock = std::make_shared<TickClock>();
  DeviceSource source(std::make_unique<CombinedDevice>(std::move(mice), settings.tickClock), scene, settings);
  devicetest::expectNothingActs(source, scene);
}

TEST(CombinedDevice, IsAskedForByName) {
  const OpenedDevice opened = openDevice("right=null,left=null", combinedTools);
  ASSERT_NE(opened.tickClock, nullptr);
  DeviceInput input;
  opened.device->poll(std::chrono::nanoseconds(0), input);
  EXPECT_EQ(input.samples.size(), 2U);
  const OpenedDevice trackers = openDevice("left=openigtlink:[::1]:5,right=openigtlink:localhost:6", combinedTools);
  EXPECT_EQ(trackers.device->info().capabilities.hands, 2);
  EXPECT_EQ(trackers.device->info().identity, "left=openigtlink:::1/LeftTool,,right=openigtlink:localhost/,RightTool");
  for (const char* name : {"left=null", "right=null", "left=null,left=null", "left=,right=null",
                           "left=null,right=", "left=null,right=joystick", "left=null,right=openigtlink",
                           "left=mouse,right=null", "left=left=null,right=null,right=null", "left=null,,right=null"}) {
    SCOPED_TRACE(name);
    expectFault(ErrorKind::invalid, "", {"device"}, [&] { openDevice(name, combinedTools); }, {Remedy::nameDevice});
  }
}

TEST(CombinedDevice, DrivesAnAttemptWithBothHands) {
  const SceneDescription scene = devicetest::emptyScene();
  auto clock = std::make_shared<TickClock>();
  auto device = std::make_unique<CombinedDevice>(
      std::array<OpenedDevice, handCount>{scripted(devicetest::movingScript(300, 1, {Hand::left})),
                                          scripted(devicetest::movingScript(300, 4, {Hand::right}))},
      clock);
  DeviceSourceSettings settings;
  settings.tickClock = clock;
  DeviceSource source(std::move(device), scene, settings);
  source.waitForFirst(1.0);
  TickSamples first, last;
  ASSERT_TRUE(source.next(0, first));
  for (std::uint64_t t = 1; t < 250; ++t) ASSERT_TRUE(source.next(t, last));
  for (std::size_t h = 0; h < handCount; ++h) {
    EXPECT_TRUE(last.hand[h].valid);
    EXPECT_NEAR((last.hand[h].position - first.hand[h].position).norm(), 0.0025, 1e-4);
  }
}

}  // namespace
}  // namespace calot::recorder
