// SPDX-License-Identifier: GPL-3.0-or-later
// The driver against a daemon that says what spacenavd says, on a socket of the test's own.
#include "recorder/sources/devices/pointer_device.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <thread>

#include "recorder/sources/devices/device_source.h"
#include "recorder/sources/devices/open_device.h"
#include "tests/recorder/sources/devices/support/device_support.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

/// Protocol 0 of spacenavd: eight integers an event.
class FakeDaemon {
 public:
  FakeDaemon() : path_(std::filesystem::temp_directory_path() / ("calot-spnav-" + std::to_string(getpid()))) {
    setenv("SPNAV_SOCKET", path_.c_str(), 1);
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
    listener_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path_.c_str(), sizeof address.sun_path - 1);
    EXPECT_EQ(::bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(::listen(listener_, 1), 0);
  }
  ~FakeDaemon() {
    hangUp();
    ::close(listener_);
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
    unsetenv("SPNAV_SOCKET");
  }
  FakeDaemon(const FakeDaemon&) = delete;
  FakeDaemon& operator=(const FakeDaemon&) = delete;

  void accept() { client_ = ::accept(listener_, nullptr, nullptr); }
  void tell(const std::array<std::int32_t, 8>& event) const {
    ASSERT_EQ(::write(client_, event.data(), sizeof event), static_cast<ssize_t>(sizeof event));
  }
  void hangUp() {
    if (client_ >= 0) ::close(client_);
    client_ = -1;
  }

 private:
  std::filesystem::path path_;
  int listener_ = -1, client_ = -1;
};

TEST(SpaceMouse, DeflectionsAreSpeedsAndALossIsTold) {
  FakeDaemon daemon;
  std::int64_t now = 1'000'000'000;
  SpaceMouse mouse(Hand::left, [&now] { return now; });
  daemon.accept();
  EXPECT_THROW(SpaceMouse(Hand::right, [&now] { return now; }), Error);  // one connection
  DeviceInput input;
  const auto run = [&](int milliseconds) {
    for (int i = 0; i < milliseconds; ++i) {
      now += 1'000'000;
      mouse.poll(std::chrono::nanoseconds(0), input);
    }
  };
  run(20);
  daemon.tell({0, 350, 175, -350, 0, 0, 350, 16});
  daemon.tell({1, 1, 0, 0, 0, 0, 0, 0});
  run(100);
  daemon.tell({0, 0, 0, 0, 0, 0, 0, 16});
  daemon.tell({2, 1, 0, 0, 0, 0, 0, 0});
  daemon.tell({1, 2, 0, 0, 0, 0, 0, 0});
  run(40);
  ASSERT_FALSE(input.samples.empty());
  const DeviceSample& s = input.samples.back();
  EXPECT_EQ(s.hand, Hand::left);
  EXPECT_NEAR(s.position.x(), 0.006, 3e-4);
  EXPECT_LT(s.position.y(), -0.001);  // up
  EXPECT_NEAR(s.position.z(), -0.006, 3e-4);
  EXPECT_NEAR(s.gripper, 0.12, 0.006);
  EXPECT_GT(s.orientation.z(), 0.05);
  EXPECT_EQ(s.buttons, button::cutPedal | button::fire);
  daemon.hangUp();
  run(20);
  EXPECT_FALSE(mouse.connected());
  EXPECT_EQ(input.events.back().kind, DeviceEvent::Kind::disconnected);
}

TEST(SpaceMouse, ABranchActsOnlyWhenTheHandDoes) {
  FakeDaemon daemon;
  const SceneDescription scene = devicetest::emptyScene();
  auto clock = std::make_shared<TickClock>();
  DeviceSourceSettings settings;
  settings.tickClock = clock;
  DeviceSource source(std::make_unique<SpaceMouse>(Hand::left, [clock] { return clock->now; }), scene, settings);
  daemon.accept();
  devicetest::expectNothingActs(source, scene);
  daemon.tell({1, 1, 0, 0, 0, 0, 0, 0});
  TickSamples now;
  for (std::uint64_t tick = 5000; tick < 5100; ++tick) ASSERT_TRUE(source.next(tick, now));
  EXPECT_NEAR(now.hand[0].jaw, 0.1 + 0.12, 0.01);
}

TEST(SpaceMouse, WithoutADaemonThatIsSaid) {
  setenv("SPNAV_SOCKET", "/nowhere/spnav", 1);
  expectFault(ErrorKind::failure, "", {"SpaceMouse"}, [&] { openDevice("spacenav", {}); }, {Remedy::listDevices});
  unsetenv("SPNAV_SOCKET");
}

}  // namespace
}  // namespace calot::recorder
