// SPDX-License-Identifier: GPL-3.0-or-later
// Events as the kernel writes them, through a named pipe in place of a mouse.
#include "recorder/sources/devices/mouse_device.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/input.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include "recorder/sources/devices/device_source.h"
#include "recorder/sources/devices/open_device.h"
#include "tests/recorder/sources/devices/support/device_support.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

class PipedMouse : public testing::Test {
 protected:
  void SetUp() override {
    static int number = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("calot-mouse-" + std::to_string(getpid()) + "-" + std::to_string(number++));
    ASSERT_EQ(mkfifo(path_.c_str(), 0600), 0);
    plugIn();
  }
  void TearDown() override {
    unplug();
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  // Read and write, so that it does not wait for a reader.
  void plugIn() { pipe_ = ::open(path_.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC); }
  void unplug() {
    if (pipe_ >= 0) ::close(pipe_);
    pipe_ = -1;
  }
  void tell(unsigned type, unsigned code, int value) const {
    input_event event{};
    event.type = static_cast<std::uint16_t>(type);
    event.code = static_cast<std::uint16_t>(code);
    event.value = value;
    ASSERT_EQ(::write(pipe_, &event, sizeof event), static_cast<ssize_t>(sizeof event));
  }
  std::unique_ptr<EvdevMouse> mouse() {
    return std::make_unique<EvdevMouse>(path_.string(), Hand::left, [this] { return now_; });
  }
  void run(EvdevMouse& mouse, int milliseconds) {
    for (int i = 0; i < milliseconds; ++i) {
      now_ += 1'000'000;
      mouse.poll(std::chrono::nanoseconds(0), input_);
    }
  }

  std::filesystem::path path_;
  int pipe_ = -1;
  std::int64_t now_ = 1'000'000'000;
  DeviceInput input_;
};

TEST_F(PipedMouse, MovesRollsAndOpensWithinItsSpeed) {
  const auto m = mouse();
  run(*m, 8);
  tell(EV_REL, REL_X, 200);
  tell(EV_REL, REL_Y, -100);
  tell(EV_REL, REL_WHEEL, 2);
  tell(EV_REL, REL_HWHEEL, 1);
  tell(EV_KEY, BTN_RIGHT, 1);
  tell(EV_SYN, SYN_REPORT, 0);
  run(*m, 200);
  tell(EV_KEY, BTN_RIGHT, 0);
  tell(EV_KEY, BTN_MIDDLE, 1);
  run(*m, 40);
  ASSERT_GT(input_.samples.size(), 50U);
  const DeviceSample& s = input_.samples.back();
  EXPECT_EQ(s.hand, Hand::left);
  EXPECT_NEAR((s.position - Vec3(0.03, -0.015, 0.006)).norm(), 0.0, 1e-12);
  EXPECT_NEAR(2.0 * std::atan2(s.orientation.z(), s.orientation.w()), 0.1, 1e-12);
  EXPECT_NEAR(s.gripper, 0.36, 0.03);
  EXPECT_EQ(s.buttons, button::cutPedal | button::fire);
  for (std::size_t i = 1; i < input_.samples.size(); ++i) {
    const Vec3 way = input_.samples[i].position - input_.samples[i - 1].position;
    EXPECT_LE(way.cwiseAbs().maxCoeff(), 0.5 * 0.004 + 1e-12);
    EXPECT_EQ(input_.samples[i].sequence, i);
  }
}

TEST_F(PipedMouse, WhatFollowsALostReportIsSkipped) {
  const auto m = mouse();
  run(*m, 8);
  tell(EV_KEY, BTN_MIDDLE, 1);
  tell(EV_SYN, SYN_DROPPED, 0);
  tell(EV_REL, REL_X, 1000);
  tell(EV_SYN, SYN_REPORT, 0);
  tell(EV_REL, REL_X, 10);
  tell(EV_SYN, SYN_REPORT, 0);
  run(*m, 40);
  EXPECT_NEAR(input_.samples.back().position.x(), 0.0015, 1e-12);
  EXPECT_EQ(input_.samples.back().buttons, 0);
}

TEST_F(PipedMouse, ComesBackAfterItWasUnplugged) {
  const auto m = mouse();
  run(*m, 8);
  tell(EV_REL, REL_X, 10);
  run(*m, 20);
  unplug();
  run(*m, 20);
  EXPECT_FALSE(m->connected());
  ASSERT_EQ(input_.events.back().kind, DeviceEvent::Kind::disconnected);
  plugIn();
  run(*m, 600);
  EXPECT_TRUE(m->connected());
  EXPECT_EQ(input_.events.back().kind, DeviceEvent::Kind::connected);
  EXPECT_NEAR(input_.samples.back().position.x(), 0.0015, 1e-12);
  m->close();
  EXPECT_FALSE(m->connected());
}

TEST_F(PipedMouse, IsAskedForByName) {
  EXPECT_EQ(openDevice("mouse:" + path_.string(), {}).device->info().name, "mouse");
  for (const std::string which : {"99", "there is no such mouse", "/nowhere/event0"}) {
    expectFault(ErrorKind::failure, "", {"\"" + which + "\""}, [&] { openDevice("mouse:" + which, {}); },
                {Remedy::listDevices});
  }
}

TEST_F(PipedMouse, ABranchActsOnlyWhenTheHandDoes) {
  const SceneDescription scene = devicetest::emptyScene();
  auto clock = std::make_shared<TickClock>();
  DeviceSourceSettings settings;
  settings.tickClock = clock;
  DeviceSource source(std::make_unique<EvdevMouse>(path_.string(), Hand::left, [clock] { return clock->now; }), scene,
                      settings);
  devicetest::expectNothingActs(source, scene);
  tell(EV_KEY, BTN_RIGHT, 1);
  TickSamples now;
  for (std::uint64_t tick = 5000; tick < 5100; ++tick) ASSERT_TRUE(source.next(tick, now));
  EXPECT_NEAR(now.hand[0].jaw, 0.1 + 0.18, 0.01);
}

}  // namespace
}  // namespace calot::recorder
