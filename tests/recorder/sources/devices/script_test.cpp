// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/device_script.h"

#include <gtest/gtest.h>

#include <set>

#include "recorder/sources/devices/open_device.h"
#include "tests/recorder/sources/devices/support/device_support.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

using devicetest::bytesOf;

const std::string head = R"({"format": "calot-device-script", "formatVersion": 1, "name": "n", "samples": )";
const std::string good = "[0, 1, 0.1, 0.2, 0.3, 1, 0, 0, 0, 0.5, 128, 1]";

TEST(DeviceScript, TextComesBackAsItWas) {
  DeviceScript script = devicetest::movingScript(50, 7, {Hand::left, Hand::right});
  script.samples[3].valid = false;
  script.samples[4].buttons = 5;
  script.samples[5].orientation = Quat(0.5, -0.5, 0.5, 0.5);
  script.samples[6].gripper = 0.25;
  script.phases.push_back({"rest", 0, 20'000'000});
  script.unpluggings.push_back({30'000'000, 4'000'000});
  const DeviceScript back = parseDeviceScript(bytesOf(deviceScriptText(script)), "s.json");
  ASSERT_EQ(back.samples.size(), script.samples.size());
  for (std::size_t i = 0; i < back.samples.size(); ++i) {
    EXPECT_EQ(back.samples[i].hostTime, script.samples[i].hostTime);
    EXPECT_EQ(back.samples[i].hand, script.samples[i].hand);
    EXPECT_EQ(back.samples[i].position, script.samples[i].position);
    EXPECT_EQ(back.samples[i].orientation.coeffs(), script.samples[i].orientation.coeffs());
    EXPECT_EQ(back.samples[i].valid, script.samples[i].valid);
    EXPECT_EQ(back.samples[i].buttons, script.samples[i].buttons);
    EXPECT_EQ(back.samples[i].gripper, script.samples[i].gripper);
  }
  ASSERT_EQ(back.phases.size(), 1U);
  EXPECT_EQ(back.phases[0].to, 20'000'000);
  ASSERT_EQ(back.unpluggings.size(), 1U);
  EXPECT_EQ(back.unpluggings[0].length, 4'000'000);
}

TEST(DeviceScript, EveryFaultIsOneLineThatNamesThePlace) {
  struct Case {
    std::string text, names;
  };
  const std::vector<Case> cases{
      {"", "s.json"},
      {"   \n", "s.json"},
      {"{", "line 1, column 2"},
      {R"({"format": "x"})", "s.json"},
      {head + "[]}", "/samples"},
      {head + "[[1, 2]]}", "/samples/0"},
      {head + "[[0, 2, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1]]}", "/samples/0/1"},
      {head + "[[0, 1, 0, 0, 11, 1, 0, 0, 0, 0, 0, 1]]}", "/samples/0/4"},
      {head + "[[0, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1]]}", "/samples/0"},
      {head + "[[0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1]]}", "/samples/0"},
      {head + "[[0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 256, 1]]}", "/samples/0/10"},
      {head + "[[1, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1], " + good + "]}", "/samples/1"},
      {head + "[[-1, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1]]}", "/samples/0/0"},
      {head + "[" + good + "], \"phases\": [{\"name\": \"rest\", \"from\": 2, \"to\": 1}]}", "/phases/0"},
      {head + "[" + good + "], \"unplug\": [{\"at\": -1, \"for\": 1}]}", "/unplug/0/at"},
      {head + "[" + good + "], \"more\": 1}", "more"},
      {"1 2 3", "s.json: line 1: 3"},
  };
  for (const Case& c : cases) {
    expectFault(ErrorKind::damaged, "", {c.names}, [&] { parseDeviceScript(bytesOf(c.text), "s.json"); });
  }
}

TEST(ScriptedDevice, PlaysOnItsClockAndStandsStillWhileUnplugged) {
  std::int64_t now = 1'000'000'000;
  DeviceScript script = devicetest::movingScript(100, 10, {Hand::right});
  script.unpluggings.push_back({35'000'000, 50'000'000});
  ScriptedDevice device(script, [&] { return now; });
  DeviceInput input;
  std::vector<std::int64_t> lost, back;
  for (; now <= 1'200'000'000; now += 1'000'000) {
    device.poll(std::chrono::nanoseconds(0), input);
  }
  ASSERT_EQ(input.samples.size(), 10U);
  EXPECT_TRUE(device.ended());
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(input.samples[i].sequence, i);
    const std::int64_t wait = i >= 4 ? 50'000'000 : 0;
    EXPECT_EQ(input.samples[i].hostTime, 1'000'000'000 + static_cast<std::int64_t>(i) * 10'000'000 + wait);
  }
  ASSERT_EQ(input.events.size(), 3U);
  EXPECT_EQ(input.events[1].kind, DeviceEvent::Kind::disconnected);
  EXPECT_EQ(input.events[1].hostTime, 1'035'000'000);
  EXPECT_EQ(input.events[2].kind, DeviceEvent::Kind::connected);
  EXPECT_EQ(input.events[2].hostTime, 1'085'000'000);
}

TEST(NullDevice, GivesBothHandsASampleATick) {
  std::int64_t now = 0;
  NullDevice device([&] { return now; });
  DeviceInput input;
  for (; now < 5'000'000; now += 1'000'000) device.poll(std::chrono::nanoseconds(0), input);
  EXPECT_EQ(input.samples.size(), 10U);
  for (const DeviceSample& s : input.samples) EXPECT_EQ(s.position, Vec3::Zero());
  device.close();
  device.poll(std::chrono::nanoseconds(0), input);
  EXPECT_EQ(input.samples.size(), 10U);
}

TEST(OpenDevice, RefusesBadNamesWithOneLine) {
  const std::array<std::string, handCount> tools{"LeftTool", "RightTool"};
  for (const char* name :
       {"", "joystick", "null:x", "gamepad:", "scripted",
        "scripted:", "openigtlink:", "openigtlink:h:", "openigtlink:h:0", "openigtlink:h:65536", "openigtlink:h:1x",
        "openigtlink::1", "openigtlink:h:1:2", "openigtlink:[::1", "openigtlink:a b:1", "openigtlink:[::1]:"}) {
    expectFault(ErrorKind::invalid, "", {std::string("\"") + name + "\""}, [&] { openDevice(name, tools); },
                {Remedy::nameDevice});
  }
  EXPECT_THROW(openDevice("openigtlink", {"", ""}), Error);
  EXPECT_THROW(openDevice("openigtlink", {"a", "a"}), Error);
  EXPECT_THROW(openDevice("openigtlink", {"abcdefghijklmnopqrstu", "a"}), Error);
  expectFault(ErrorKind::damaged, "", {"there-is-none.json"},
              [&] { openDevice("scripted:/nowhere/there-is-none.json", tools); });
  EXPECT_EQ(openDevice("openigtlink:[::1]:5", tools).device->info().name, "openigtlink");
  EXPECT_EQ(openDevice("openigtlink", {"", "Probe"}).device->info().capabilities.hands, 1);
}

TEST(DeviceTable, RowsAreCompleteAndNamesUnique) {
  std::set<std::string> names;
  for (const DeviceKind* kind : deviceKinds()) {
    EXPECT_TRUE(names.insert(kind->name).second) << kind->name;
    EXPECT_TRUE(std::string(kind->usage).starts_with(kind->name)) << kind->usage;
    EXPECT_FALSE(std::string(kind->help).empty()) << kind->name;
    EXPECT_EQ(std::string(kind->help).find('\n'), std::string::npos) << kind->name;
    EXPECT_EQ(findDeviceKind(kind->name), kind);
    EXPECT_EQ(findDeviceKind(std::string(kind->name) + ":more"), kind);
    EXPECT_EQ(deviceUsage().find(kind->usage) == std::string::npos, kind->needsWindow) << kind->name;
    const std::vector<ListedDevice> listed = kind->listed();
    EXPECT_FALSE(listed.empty()) << kind->name;
    for (const ListedDevice& device : listed) EXPECT_EQ(findDeviceKind(device.name), kind) << device.name;
  }
  EXPECT_EQ(findDeviceKind("joystick"), nullptr);
}

}  // namespace
}  // namespace calot::recorder
