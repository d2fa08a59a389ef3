// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "recorder/sources/devices/device_script.h"
#include "recorder/sources/devices/device_source.h"
#include "sim/scene/description.h"

namespace calot::recorder::devicetest {

/// A scene of two hands and a camera that is turned against W; no organs.
inline SceneDescription emptyScene() {
  SceneDescription scene;
  scene.name = "empty";
  scene.hands[0].port = Vec3(0.05, 0.1, -0.06);
  scene.hands[0].home = Vec3(0.03, 0.03, -0.06);
  scene.hands[1].port = Vec3(-0.06, 0.1, -0.03);
  scene.hands[1].home = Vec3(-0.03, 0.03, -0.05);
  scene.camera.position = Vec3(0.0, 0.05, -0.13);
  scene.camera.orientation = Quat(0.5, 0.5, -0.5, 0.5);
  return scene;
}

inline std::vector<std::byte> bytesOf(const std::string& text) {
  std::vector<std::byte> bytes(text.size());
  if (!text.empty()) std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

inline DeviceSample sampleAt(std::int64_t milliseconds, Hand hand, const Vec3& position) {
  DeviceSample s;
  s.hostTime = s.deviceTime = milliseconds * 1'000'000;
  s.hand = hand;
  s.position = position;
  return s;
}

/// A hand that moves along x at 10 mm/s, a sample every `every` ms for `length` ms.
inline DeviceScript movingScript(std::int64_t length, std::int64_t every, const std::vector<Hand>& hands) {
  DeviceScript script;
  script.name = "mover";
  script.file = "mover.json";
  script.rate = 1000.0 / static_cast<double>(every);
  std::uint64_t sequence = 0;
  for (std::int64_t t = 0; t < length; t += every, ++sequence) {
    for (const Hand hand : hands) {
      script.samples.push_back(sampleAt(t, hand, Vec3(1e-5 * static_cast<double>(t), 0.0, 0.0)));
      script.samples.back().sequence = sequence;
    }
  }
  return script;
}

/// Where an attempt goes on: tips in the scene, jaws about a duct, the left grasper locked, pedals down.
inline TickSamples leftInMidAction(const SceneDescription& scene) {
  TickSamples start;
  for (std::size_t h = 0; h < handCount; ++h) {
    InstrumentSample& hand = start.hand[h];
    hand.position = scene.hands[h].home + Vec3(0.01, 0.002, -0.003);
    hand.orientation = Quat(0.5, 0.5, 0.5, 0.5);
    hand.jaw = h == 0 ? 0.1 : 0.75;
    hand.instrument = h == 0 ? InstrumentKind::grasper : InstrumentKind::scissors;
    hand.buttons = button::cutPedal | button::fire;
  }
  start.hand[0].buttons |= button::lock;
  return roundedToGrid(start);
}

/// Goes on from leftInMidAction() and asks nothing of the device for five seconds: tips, jaws and locks stay, and no
/// pedal acts, for each hand that the device measures. @pre before the first tick; on the tick clock
inline void expectNothingActs(DeviceSource& source, const SceneDescription& scene) {
  const TickSamples start = leftInMidAction(scene);
  source.waitForFirst(1.0);
  source.setOutFrom(start);
  TickSamples now;
  int measured = 0;
  for (std::uint64_t tick = 0; tick < 5000; ++tick) {
    ASSERT_TRUE(source.next(tick, now));
    for (std::size_t h = 0; h < handCount; ++h) {
      const InstrumentSample& hand = now.hand[h];
      if (!hand.valid) continue;
      ++measured;
      ASSERT_EQ(hand.position, start.hand[h].position) << "tick " << tick;
      ASSERT_EQ(hand.jaw, start.hand[h].jaw) << "tick " << tick;
      ASSERT_EQ(hand.buttons, start.hand[h].buttons & button::lock) << "tick " << tick;
    }
  }
  EXPECT_GE(measured, 4900);
}

}  // namespace calot::recorder::devicetest
