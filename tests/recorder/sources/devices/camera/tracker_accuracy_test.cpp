// SPDX-License-Identifier: GPL-3.0-or-later
// How exact poses are, over rendered pictures of known motion.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "recorder/sources/devices/camera/handle_tracker.h"
#include "tests/recorder/sources/devices/camera/support/marker_scene.h"

namespace calot::recorder {
namespace {

using namespace cameratest;

constexpr double period = 1.0 / 30.0;

struct Outcome {
  double rms = 0.0, ninetyFive = 0.0, worst = 0.0, turn95 = 0.0;  // m, rad
  int believed = 0, frames = 0;
};

struct Condition {
  const char* name;
  int cameras;
  Imaging imaging;
  double readout = 0.0;
  bool occluded = false;
};

Outcome measured(const Condition& condition, int frames, std::uint64_t seed) {
  const CameraRig rig = rigOfCameras(condition.cameras, condition.readout);
  Random random(seed);
  std::vector<HandleTracker> trackers;
  for (const Hand hand : {Hand::left, Hand::right}) trackers.emplace_back(rig, hand);
  const TagDetector detect = makeTagDetector();
  std::vector<double> errors, turns;
  Outcome out;
  for (int f = 0; f < frames; ++f) {
    const double time = f * period;
    std::vector<SeenFrame> seen;
    for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
      std::vector<Body> bodies;
      for (const Hand hand : {Hand::left, Hand::right})
        bodies.push_back(handleBody(hand, [hand](double t) { return handMotion(hand, t); }));
      std::optional<Occluder> occluder;
      // A hand that passes before the handles.
      if (condition.occluded) {
        const double x = 1280.0 * (0.5 + 0.45 * std::sin(2.0 * time));
        occluder = Occluder{x - 90.0, 250.0, x + 90.0, 720.0};
      }
      seen.push_back({c, static_cast<std::int64_t>(std::floor(1e9 * time + 0.5)),
                      detect(rendered(rig.cameras[c], bodies, time, condition.imaging, random, occluder))});
    }
    for (const Hand hand : {Hand::left, Hand::right}) {
      const HandleSight sight = trackers[static_cast<std::size_t>(hand)].track(seen);
      ++out.frames;
      if (sight.fault != PoseFault::none) continue;
      ++out.believed;
      const Pose truth = handMotion(hand, 1e-9 * static_cast<double>(sight.time));
      errors.push_back((sight.pose.position - truth.position).norm());
      turns.push_back(2.0 * std::acos(std::min(1.0, std::abs(sight.pose.orientation.dot(truth.orientation)))));
    }
  }
  std::sort(errors.begin(), errors.end());
  std::sort(turns.begin(), turns.end());
  for (const double e : errors) out.rms += e * e / static_cast<double>(errors.size());
  out.rms = std::sqrt(out.rms);
  if (!errors.empty()) {
    out.ninetyFive = errors[errors.size() * 95 / 100];
    out.worst = errors.back();
    out.turn95 = turns[turns.size() * 95 / 100];
  }
  fmt::print(
      "{:<34} {} camera(s): rms {:.2f} mm, 95 % {:.2f} mm, worst {:.2f} mm, turn 95 % {:.2f} deg, believed {} of {}\n",
      condition.name, condition.cameras, 1e3 * out.rms, 1e3 * out.ninetyFive, 1e3 * out.worst, 57.29578 * out.turn95,
      out.believed, out.frames);
  return out;
}

Imaging clear() { return {}; }
Imaging harsh() {
  Imaging i;
  i.exposure = 0.012;
  i.moments = 4;
  i.noise = 5.0;
  i.lensBlur = 1.0;
  i.gradient = 0.7;
  i.light = 0.55;
  return i;
}

void expectWithin(const Outcome& o, double limit, double leastBelieved) {
  EXPECT_LT(o.rms, limit);
  EXPECT_LT(o.ninetyFive, limit);
  EXPECT_LT(o.worst, 3.0 * limit);  // never a wrong pose
  EXPECT_LT(o.turn95, 0.05);
  EXPECT_GE(o.believed, leastBelieved * o.frames);
}

TEST(TrackerAccuracy, TwoCamerasAreWithinFifteenTenths) {
  expectWithin(measured({"clear", 2, clear()}, 6, 1), 0.0015, 0.9);
}

TEST(TrackerAccuracy, OneCameraIsWithinThreeMillimetres) {
  expectWithin(measured({"clear", 1, clear()}, 8, 2), 0.003, 0.8);
}

TEST(TrackerAccuracy, BlurNoiseRowsAndShade) {
  expectWithin(measured({"blur, noise, rows, shade", 2, harsh(), 0.02}, 4, 3), 0.0015, 0.7);
  expectWithin(measured({"blur, noise, rows, shade", 1, harsh(), 0.02}, 5, 4), 0.003, 0.5);
}

TEST(TrackerAccuracyHeavy, Matrix) {
  if (std::getenv("CALOT_HEAVY") == nullptr) GTEST_SKIP() << "set CALOT_HEAVY";
  Imaging dark = clear();
  dark.light = 0.25;
  dark.noise = 6.0;
  Imaging blurred = clear();
  blurred.exposure = 0.02;
  blurred.moments = 8;
  for (const int cameras : {1, 2}) {
    const double limit = cameras == 2 ? 0.0015 : 0.003;
    const int frames = 60;
    std::uint64_t seed = 100;
    expectWithin(measured({"clear", cameras, clear()}, frames, ++seed), limit, 0.8);
    expectWithin(measured({"rolling exposure, 25 ms", cameras, clear(), 0.025}, frames, ++seed), limit, 0.8);
    expectWithin(measured({"exposed for 20 ms", cameras, blurred}, frames, ++seed), limit, 0.5);
    expectWithin(measured({"dark and noisy", cameras, dark}, frames, ++seed), limit, 0.5);
    expectWithin(measured({"blur, noise, rows, shade", cameras, harsh(), 0.02}, frames, ++seed), limit, 0.5);
    expectWithin(measured({"a hand in the way", cameras, clear(), 0.0, true}, frames, ++seed), limit, 0.4);
  }
}

}  // namespace
}  // namespace calot::recorder
