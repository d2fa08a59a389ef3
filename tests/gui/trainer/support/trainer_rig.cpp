// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/gui/trainer/support/trainer_rig.h"

#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "recorder/base/errors.h"
#include "recorder/replay.h"
#include "recorder/sources/devices/device_script.h"
#include "recorder/sources/devices/device_source.h"

namespace calot::gui::trainertest {

std::unique_ptr<recorder::SampleSource> ScriptInput::open(const SceneDescription& scene) {
  if (!refusal.empty()) throw Error(ErrorKind::failure, refusal);
  recorder::DeviceSourceSettings settings;
  settings.tickClock = std::make_shared<recorder::TickClock>();
  auto source = std::make_unique<recorder::DeviceSource>(
      std::make_unique<recorder::ScriptedDevice>(script_, [clock = settings.tickClock] { return clock->now; }), scene,
      settings);
  source->waitForFirst(1.0);
  return source;
}

recorder::DeviceScript swayingScript(double seconds) {
  recorder::DeviceScript script;
  script.name = "sway";
  script.file = "sway.json";
  script.rate = 200.0;
  for (std::int64_t ms = 0; ms < static_cast<std::int64_t>(1000.0 * seconds); ms += 5) {
    for (const Hand hand : {Hand::left, Hand::right}) {
      const double t = 1e-3 * static_cast<double>(ms);
      recorder::DeviceSample s;
      s.hostTime = s.deviceTime = ms * 1'000'000;
      s.sequence = static_cast<std::uint64_t>(ms / 5);
      s.hand = hand;
      s.position = Vec3(0.01 * std::sin(2.0 * t), 0.005 * std::sin(3.0 * t), 0.002 * t);
      s.gripper = hand == Hand::right ? 0.4 * (1.0 - std::cos(6.283185307179586 * t)) : 0.0;
      script.samples.push_back(s);
    }
  }
  return script;
}

recorder::LoadedScene smallLoadedScene() { return recorder::sceneFromAssets(recorder::test::smallScene().assets); }

TrainingSettings smallSettings(const recorder::test::Folder& folder) {
  TrainingSettings settings;
  settings.scene = smallLoadedScene();
  settings.attempt.participant = "P7";
  settings.attempt.seed = 3;
  settings.folder = folder / "";
  settings.exchange = std::chrono::milliseconds(200);
  settings.countdown = std::chrono::milliseconds(100);
  return settings;
}

bool waitFor(const std::function<bool()>& there) {
  const auto limit = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (!there()) {
    if (std::chrono::steady_clock::now() > limit) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

bool waitForTime(const TrainingSession& session, double time) {
  return waitFor([&] {
    const TrainingStatus status = session.status();
    return status.stage == Stage::running && status.figures.time >= time;
  });
}

void expectExact(const std::filesystem::path& file) {
  const recorder::ReplayReport report = recorder::replayRecording(file, {});
  EXPECT_EQ(report.verdict, recorder::ReplayVerdict::exact) << report.error;
  EXPECT_TRUE(report.complete) << file;
  EXPECT_GT(report.steps, 0U) << file;
}

}  // namespace calot::gui::trainertest
