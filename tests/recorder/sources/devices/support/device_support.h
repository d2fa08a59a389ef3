// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "recorder/sources/devices/device_script.h"
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

}  // namespace calot::recorder::devicetest
