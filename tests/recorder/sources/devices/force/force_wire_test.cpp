// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/force/force_wire.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "sim/math/random.h"

namespace calot::recorder {
namespace {

using forcewire::Decoder;
using forcewire::Frame;
using forcewire::Hello;
using forcewire::Pose;
using forcewire::WrenchFrame;

Hello someHello() {
  Hello h;
  h.hands = 3;
  h.rate = 2000.0;
  h.handle.force = {8.0, 0.3, 0.05, 1e-5, 0.0005};
  h.workspace = {Vec3(-0.1, -0.2, -0.3), Vec3(0.1, 0.2, 0.3)};
  h.name = "a device";
  h.serial = "17";
  return h;
}

Pose somePose() {
  Pose p;
  p.hand = Hand::left;
  p.buttons = 0x81;
  p.number = 77;
  p.sequence = 123456789012345U;
  p.deviceTime = 987654321;
  p.position = Vec3(0.1, -0.2, 0.3);
  p.orientation = Quat(0.5, 0.5, -0.5, 0.5);
  p.gripper = 0.4;
  p.shown.force = Vec3(1, 2, 3);
  return p;
}

TEST(ForceWire, FramesComeBackInPiecesOfAnySize) {
  const std::vector<Frame> sent{someHello(),
                                forcewire::Welcome{1, 2},
                                somePose(),
                                WrenchFrame{Hand::right, 78, 5, {Vec3(1, 0, -1), Vec3(0, 2, 0)}},
                                forcewire::Fault{"no"},
                                forcewire::End{}};
  std::vector<std::byte> stream;
  for (const Frame& frame : sent) {
    const auto bytes = forcewire::encode(frame);
    stream.insert(stream.end(), bytes.begin(), bytes.end());
  }
  for (const std::size_t piece : {std::size_t{1}, std::size_t{7}, stream.size()}) {
    Decoder decoder;
    std::vector<Frame> got;
    for (std::size_t at = 0; at < stream.size(); at += piece) {
      const std::size_t n = std::min(piece, stream.size() - at);
      ASSERT_TRUE(decoder.take(std::span(stream).subspan(at, n), got));
    }
    ASSERT_EQ(got.size(), sent.size());
    const auto& hello = std::get<Hello>(got[0]);
    EXPECT_EQ(hello.name, "a device");
    EXPECT_EQ(hello.serial, "17");
    EXPECT_EQ(hello.handle.force.quantum, 1e-5);
    EXPECT_EQ(hello.handle.force.period, 0.0005);
    EXPECT_EQ(hello.workspace[1], Vec3(0.1, 0.2, 0.3));
    EXPECT_TRUE(forcewire::faultOf(hello).empty());
    const auto& pose = std::get<Pose>(got[2]);
    EXPECT_EQ(pose.hand, Hand::left);
    EXPECT_EQ(pose.number, 77U);
    EXPECT_EQ(pose.sequence, 123456789012345U);
    EXPECT_EQ(pose.position, Vec3(0.1, -0.2, 0.3));
    EXPECT_EQ(pose.orientation.coeffs(), Quat(0.5, 0.5, -0.5, 0.5).coeffs());
    EXPECT_EQ(pose.shown.force, Vec3(1, 2, 3));
    EXPECT_EQ(std::get<WrenchFrame>(got[3]).wrench.torque, Vec3(0, 2, 0));
    EXPECT_EQ(std::get<forcewire::Fault>(got[4]).text, "no");
  }
}

/// The lengths and places of schemas/device.md, read by hand.
TEST(ForceWire, BytesStandWhereTheSchemaSays) {
  const auto hello = forcewire::encode(someHello());
  ASSERT_EQ(hello.size(), 4U + 232U);
  EXPECT_EQ(std::to_integer<int>(hello[0]), 232);
  EXPECT_EQ(std::to_integer<int>(hello[2]), 1);
  EXPECT_EQ(std::to_integer<char>(hello[4]), 'c');
  EXPECT_EQ(std::to_integer<int>(hello[4 + 10]), 3);
  EXPECT_EQ(std::to_integer<char>(hello[4 + 136]), 'a');
  EXPECT_EQ(std::to_integer<char>(hello[4 + 200]), '1');
  const auto pose = forcewire::encode(somePose());
  ASSERT_EQ(pose.size(), 4U + 136U);
  EXPECT_EQ(std::to_integer<int>(pose[4 + 2]), 0x81);
  EXPECT_EQ(std::to_integer<int>(pose[4 + 4]), 77);
  EXPECT_EQ(forcewire::encode(WrenchFrame{}).size(), 4U + 64U);
  EXPECT_EQ(forcewire::encode(forcewire::Welcome{}).size(), 4U + 16U);
  EXPECT_EQ(forcewire::encode(forcewire::End{}).size(), 4U);
}

TEST(ForceWire, AnotherProtocolIsRefused) {
  using namespace std::string_literals;
  for (const std::string& text : {"HTTP/1.1 200 OK\r\n\r\n"s, "\x04\x00\x09\x00...."s, "\xff\xff\x05\x00"s}) {
    Decoder decoder;
    std::vector<Frame> got;
    std::vector<std::byte> bytes(text.size());
    std::memcpy(bytes.data(), text.data(), text.size());
    EXPECT_FALSE(decoder.take(bytes, got));
    EXPECT_FALSE(decoder.fault().empty());
    EXPECT_TRUE(got.empty());
  }
  auto bytes = forcewire::encode(someHello());
  bytes[5] = std::byte{'x'};
  Decoder decoder;
  std::vector<Frame> got;
  EXPECT_FALSE(decoder.take(bytes, got));
}

TEST(ForceWire, NoBytesBreakTheDecoder) {
  Random random(3, 1);
  for (int i = 0; i < 2000; ++i) {
    std::vector<std::byte> bytes = forcewire::encode(somePose());
    for (int k = 0; k < 3; ++k) {
      bytes[random.next() % bytes.size()] = static_cast<std::byte>(random.next() & 0xffU);
    }
    Decoder decoder;
    std::vector<Frame> got;
    if (!decoder.take(bytes, got)) continue;
    for (const Frame& frame : got) {
      if (const auto* pose = std::get_if<Pose>(&frame)) forcewire::isPose(*pose);
    }
  }
}

TEST(ForceWire, NonsenseIsSaidInOneLine) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  std::vector<Hello> wrong(6, someHello());
  wrong[0].version = 2;
  wrong[1].hands = 0;
  wrong[2].rate = none;
  wrong[3].watchdog = 0;
  wrong[4].handle.force.maxEffort = -1.0;
  wrong[5].workspace[0].x() = none;
  for (const Hello& h : wrong) {
    EXPECT_FALSE(forcewire::faultOf(h).empty());
    EXPECT_EQ(forcewire::faultOf(h).find('\n'), std::string::npos);
  }
  Pose pose = somePose();
  EXPECT_TRUE(forcewire::isPose(pose));
  pose.orientation.w() = 0.9;
  EXPECT_FALSE(forcewire::isPose(pose));
  pose = somePose();
  pose.position.x() = 11.0;
  EXPECT_FALSE(forcewire::isPose(pose));
}

}  // namespace
}  // namespace calot::recorder
