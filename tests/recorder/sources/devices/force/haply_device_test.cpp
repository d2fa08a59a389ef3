// SPDX-License-Identifier: GPL-3.0-or-later
// The driver of the Inverse3 against a simulated service. Not yet run on hardware.
#include "recorder/sources/devices/force/haply_device.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>

#include "recorder/sources/devices/open_device.h"
#include "tests/recorder/sources/devices/force/support/haply_service.h"
#include "tests/support/fault.h"

namespace calot::recorder::haply_device_test {
namespace {

using devicetest::HaplyService;
using std::chrono::milliseconds;

HaplySettings serviceAt(int port) {
  HaplySettings out;
  out.host = "127.0.0.1";
  out.port = port;
  return out;
}

bool pollUntil(HaplyDevice& device, DeviceInput& input, const std::function<bool()>& done) {
  for (int i = 0; i < 3000 && !done(); ++i) device.poll(milliseconds(2), input);
  return done();
}

TEST(HaplyDevice, TurnsItsFrameAndShowsForcesWithinTheLimit) {
  HaplyService service({"right"});
  HaplyDevice device(serviceAt(service.port()));
  EXPECT_EQ(device.info().capabilities.hands, 1);
  DeviceInput input;
  ASSERT_TRUE(pollUntil(device, input, [&] { return input.samples.size() >= 100; }));
  EXPECT_TRUE(service.introduced());
  EXPECT_EQ(input.samples.back().hand, Hand::right);
  // 120 mm forward and 150 mm up: away, and upwards against D's y.
  EXPECT_NEAR((input.samples.back().position - Vec3(0.0, -0.15, 0.12)).norm(), 0.0, 1e-4);
  // D's z is away: the device's y.
  ASSERT_TRUE(pollUntil(device, input, [&] {
    device.setWrench(Hand::right, {Vec3(0, 0, 0.8), Vec3::Zero()});
    return input.samples.size() >= 900;
  }));
  // Not far: a force that draws has no energy to come from.
  EXPECT_GT(input.samples.back().position.z(), 0.1205);
  EXPECT_NEAR(input.samples.back().position.y(), -0.15, 1e-3);
  ASSERT_TRUE(pollUntil(device, input, [&] {
    device.setWrench(Hand::right, {Vec3(100, 0, 0), Vec3::Zero()});
    return input.samples.size() >= 1200;
  }));
  device.close();
  EXPECT_LE(service.maxForce(), 3.0);
  EXPECT_GT(service.maxForce(), 0.3);
  EXPECT_EQ(device.forceStatistics()[0].sent, 0U);
  EXPECT_GT(device.forceStatistics()[1].sent, 0U);
}

TEST(HaplyDevice, ButtonsOpenCloseCutAndClutch) {
  HaplyService service({"left"});
  HaplyDevice device(serviceAt(service.port()));
  DeviceInput input;
  const auto after = [&](std::size_t more) {
    const std::size_t wanted = input.samples.size() + more;
    EXPECT_TRUE(pollUntil(device, input, [&] { return input.samples.size() >= wanted; }));
    return input.samples.back();
  };
  service.press("b", true);
  EXPECT_GT(after(200).gripper, 0.1);
  service.press("a", true);
  after(3);
  EXPECT_EQ(after(5).buttons & clutchButton, clutchButton);
  service.press("a", false);
  service.press("b", false);
  service.press("c", true);
  after(3);
  EXPECT_EQ(after(5).buttons, button::cutPedal | button::fire);
  EXPECT_EQ(input.samples.back().hand, Hand::left);
}

TEST(HaplyDevice, SetsOutWithTheJawThatTheHandHad) {
  HaplyService service({"left"});
  HaplyDevice device(serviceAt(service.port()));
  DeviceInput input;
  device.setOut(Hand::left, {0.7, false});
  ASSERT_TRUE(pollUntil(device, input, [&] { return input.samples.size() >= 20; }));
  for (const DeviceSample& s : input.samples) EXPECT_EQ(s.gripper, 0.7);
  service.press("a", true);
  const std::size_t before = input.samples.size();
  ASSERT_TRUE(pollUntil(device, input, [&] { return input.samples.size() >= before + 200; }));
  EXPECT_LT(input.samples.back().gripper, 0.65);
}

TEST(HaplyDevice, TwoDevicesDriveTwoHandsAndALossIsTold) {
  auto service = std::make_unique<HaplyService>(std::vector<std::string>{"left", "right"});
  const int port = service->port();
  HaplyDevice device(serviceAt(port));
  EXPECT_EQ(device.info().capabilities.hands, 2);
  DeviceInput input;
  ASSERT_TRUE(pollUntil(device, input, [&] { return input.samples.size() >= 20; }));
  service.reset();
  const auto last = [&](DeviceEvent::Kind kind) { return !input.events.empty() && input.events.back().kind == kind; };
  ASSERT_TRUE(pollUntil(device, input, [&] {
    for (const DeviceEvent& e : input.events) {
      if (e.kind == DeviceEvent::Kind::disconnected) return true;
    }
    return false;
  }));
  service =
      std::make_unique<HaplyService>(std::vector<std::string>{"left", "right"}, static_cast<unsigned short>(port));
  EXPECT_TRUE(pollUntil(device, input, [&] { return last(DeviceEvent::Kind::connected); }));
}

TEST(HaplyDevice, NoServiceAndNoDeviceAreSaid) {
  EXPECT_THROW(openDevice("haply:127.0.0.1:1", {}), Error);
  HaplyService service({});
  expectFault(ErrorKind::failure, "", {"Inverse3"}, [&] { HaplyDevice device(serviceAt(service.port())); },
              {Remedy::listDevices});
}

}  // namespace
}  // namespace calot::recorder::haply_device_test
