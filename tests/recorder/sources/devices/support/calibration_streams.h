// SPDX-License-Identifier: GPL-3.0-or-later
// Streams of a tool whose calibration is known.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "recorder/sources/devices/device_script.h"
#include "sim/math/random.h"
#include "tests/recorder/sources/devices/support/device_support.h"

namespace calot::recorder::devicetest {

inline const Vec3 trueTip(0.012, -0.034, 0.21);
inline const Vec3 truePivot(0.4, -0.3, 1.2);
inline constexpr double pi = 3.141592653589793;

/// A tool whose tip stays at the pivot, tilted by up to `tilt` (rad).
inline std::vector<DeviceSample> pivotStream(std::size_t count, double tilt, double noise, std::uint64_t seed) {
  Random random(seed, 3);
  std::vector<DeviceSample> out;
  for (std::size_t i = 0; i < count; ++i) {
    const double around = random.uniform(0.0, 2.0 * pi), by = random.uniform(0.0, tilt);
    const Quat q(Eigen::AngleAxisd(by, Vec3(std::cos(around), std::sin(around), 0.0)) *
                 Eigen::AngleAxisd(random.uniform(-tilt, tilt), Vec3::UnitZ()));
    DeviceSample s = sampleAt(static_cast<std::int64_t>(i) * 10, Hand::right, truePivot - q * trueTip);
    for (int k = 0; k < 3; ++k) s.position[k] += noise * random.normal();
    s.orientation = q;
    out.push_back(s);
  }
  return out;
}

/// A whole stream: rest, pivot, three strokes of 100 mm that the device measures as 80, at 100 Hz, both hands.
inline DeviceScript wholeStream(double noise) {
  Random random(11, 5);
  DeviceScript script;
  script.name = "tracker";
  script.file = "tracker.json";
  const Quat axes(Eigen::AngleAxisd(0.5, Vec3::UnitY()));
  std::int64_t t = 0;
  const auto phase = [&](const char* name, const std::vector<DeviceSample>& samples) {
    script.phases.push_back({name, t * 1'000'000, (t + 10 * static_cast<std::int64_t>(samples.size())) * 1'000'000});
    for (DeviceSample s : samples) {
      s.hostTime = t * 1'000'000;
      for (const Hand hand : {Hand::left, Hand::right}) {
        s.hand = hand;
        DeviceSample shaken = s;
        for (int k = 0; k < 3; ++k) shaken.position[k] += noise * random.normal();
        script.samples.push_back(shaken);
      }
      t += 10;
    }
  };
  phase("rest", std::vector<DeviceSample>(300, sampleAt(0, Hand::left, Vec3(1, 1, 1))));
  phase("pivot", pivotStream(500, 0.7, 0.0, 2));
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<DeviceSample> samples;
    for (int i = 0; i < 200; ++i) {
      const double s = std::clamp((i - 40) / 120.0, 0.0, 1.0);
      samples.push_back(sampleAt(0, Hand::left, axes.conjugate() * (0.08 * s * Vec3::Unit(axis))));
    }
    phase(std::array<const char*, 3>{"stroke right", "stroke down", "stroke away"}[static_cast<std::size_t>(axis)],
          samples);
  }
  return script;
}

inline DeviceInfo trackerInfo() {
  DeviceInfo info;
  info.name = "openigtlink";
  info.identity = "openigtlink:h/a,b";
  info.capabilities.hands = 2;
  return info;
}

}  // namespace calot::recorder::devicetest
