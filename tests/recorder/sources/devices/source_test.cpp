// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/device_source.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "recorder/formats/scene_file.h"
#include "recorder/live/worker_pool.h"
#include "recorder/loop.h"
#include "recorder/recording/reader.h"
#include "recorder/recording/writer.h"
#include "recorder/replay.h"
#include "recorder/sources/devices/device_script.h"
#include "recorder/sources/pointing.h"
#include "sim/scene/model.h"
#include "tests/recorder/sources/devices/support/device_support.h"
#include "tests/support/fault.h"

namespace calot::recorder::source_test {
namespace {

using devicetest::emptyScene;
using devicetest::movingScript;
using devicetest::sampleAt;

struct Rig {
  std::shared_ptr<TickClock> clock = std::make_shared<TickClock>();
  ScriptedDevice* device = nullptr;
  std::unique_ptr<DeviceSource> source;

  Rig(const DeviceScript& script, const SceneDescription& scene, DeviceSourceSettings settings = {}) {
    auto made = std::make_unique<ScriptedDevice>(script, [c = clock] { return c->now; });
    device = made.get();
    settings.tickClock = clock;
    source = std::make_unique<DeviceSource>(std::move(made), scene, std::move(settings));
  }

  /// All raw samples that wait.
  std::vector<RawSample> raw() const {
    std::vector<RawSample> out;
    for (RawSample r; source->rawSamples().take(std::numeric_limits<std::uint64_t>::max(), r);) out.push_back(r);
    return out;
  }
};

constexpr double grid = 1.0 / 1048576.0;

TEST(DeviceSource, StartsAtHomeAndFollowsTheCamerasAxes) {
  const SceneDescription scene = emptyScene();
  Rig rig(movingScript(1000, 1, {Hand::left, Hand::right}), scene);
  rig.source->waitForFirst(1.0);
  TickSamples tick;
  ASSERT_TRUE(rig.source->next(0, tick));
  for (std::size_t h = 0; h < handCount; ++h) {
    EXPECT_NEAR((tick.hand[h].position - scene.hands[h].home).norm(), 0.0, 2 * grid);
    EXPECT_NEAR(tick.hand[h].orientation.angularDistance(pointing(scene.hands[h].port, scene.hands[h].home)), 0.0,
                1e-3);
    EXPECT_TRUE(tick.hand[h].valid);
  }
  for (std::uint64_t i = 1; i <= 500; ++i) ASSERT_TRUE(rig.source->next(i, tick));
  // 500 ms at 10 mm/s along D's x, which is the picture's right.
  const Vec3 moved = tick.hand[1].position - scene.hands[1].home;
  EXPECT_NEAR((moved - scene.camera.orientation * Vec3(0.005, 0, 0)).norm(), 0.0, 1e-5);
  // On the grid: rounding again changes nothing.
  const TickSamples again = roundedToGrid(tick);
  EXPECT_EQ(again.hand[1].position, tick.hand[1].position);
  EXPECT_EQ(again.hand[1].orientation.coeffs(), tick.hand[1].orientation.coeffs());
}

TEST(DeviceSource, CalibrationGivesAxesScaleAndTip) {
  const SceneDescription scene = emptyScene();
  DeviceScript script;
  script.name = "turner";
  script.samples.push_back(sampleAt(0, Hand::right, Vec3(0.1, 0.2, 0.3)));
  // Turned by 90 degrees about D's z: the tip, 50 mm along the sensor's x, goes from +x to +y.
  script.samples.push_back(sampleAt(10, Hand::right, Vec3(0.1, 0.2, 0.3)));
  script.samples.back().orientation = Quat(Eigen::AngleAxisd(1.5707963267948966, Vec3::UnitZ()));
  script.samples.push_back(sampleAt(100, Hand::right, Vec3(0.1, 0.2, 0.3)));
  DeviceSourceSettings settings;
  settings.calibration.emplace();
  HandCalibration hand;
  hand.tipOffset = Vec3(0.05, 0, 0);
  hand.scale = 0.5;
  hand.axes = Quat(Eigen::AngleAxisd(3.141592653589793, Vec3::UnitX()));  // D's y is up, z towards the operator
  settings.calibration->hand[1] = hand;
  Rig rig(script, scene, settings);
  TickSamples tick;
  for (std::uint64_t i = 0; i < 20; ++i) ASSERT_TRUE(rig.source->next(i, tick));
  const Vec3 inD(-0.05, 0.05, 0.0);
  const Vec3 inC(0.5 * inD.x(), -0.5 * inD.y(), 0.0);
  EXPECT_NEAR((tick.hand[1].position - scene.hands[1].home - scene.camera.orientation * inC).norm(), 0.0, 3 * grid);
  EXPECT_NE(rig.source->provenance().calibration.find("\"scale\":0.5"), std::string::npos);
}

TEST(DeviceSource, HoldsTheNewestAndSaysWhenItIsOld) {
  DeviceScript script = movingScript(50, 10, {Hand::right});
  for (DeviceSample& s : movingScript(20, 10, {Hand::right}).samples) {
    s.hostTime += 300'000'000;
    script.samples.push_back(s);
  }
  script.samples[3].valid = false;
  script.samples[3].position = Vec3(9, 9, 9);
  Rig rig(script, emptyScene());
  std::vector<bool> valid;
  std::vector<Vec3> position;
  TickSamples tick;
  for (std::uint64_t i = 0; rig.source->next(i, tick); ++i) {
    valid.push_back(tick.hand[1].valid);
    position.push_back(tick.hand[1].position);
    EXPECT_EQ(tick.hand[0].instrument, InstrumentKind::none);
    EXPECT_FALSE(tick.hand[0].valid);
  }
  ASSERT_GE(valid.size(), 310U);
  EXPECT_EQ(position[31], position[25]);  // the invalid sample at 30 ms changes nothing
  EXPECT_NE(position[41], position[31]);
  EXPECT_TRUE(valid[140]);
  EXPECT_FALSE(valid[142]);                // the last sample was at 40 ms
  EXPECT_EQ(position[200], position[41]);  // held
  EXPECT_TRUE(valid[301]);
  EXPECT_EQ(rig.source->counts().invalid, 1U);
  EXPECT_EQ(rig.source->counts().samples, 7U);
  const std::vector<RawSample> raw = rig.raw();
  ASSERT_EQ(raw.size(), 7U);
  EXPECT_FALSE(raw[3].sample.valid);
  EXPECT_FALSE(raw[3].used);
  EXPECT_EQ(raw[4].tick, 40U);
  EXPECT_EQ(position[raw[4].tick], position[200]);
  EXPECT_EQ(std::count_if(raw.begin(), raw.end(), [](const RawSample& r) { return r.used; }), 6);
}

TEST(DeviceSource, TheClutchRestsTheInstrument) {
  DeviceScript script = movingScript(300, 1, {Hand::right});
  for (std::size_t i = 100; i < 200; ++i) {
    script.samples[i].buttons = clutchButton | button::fire;
  }
  Rig rig(script, emptyScene());
  TickSamples tick;
  std::vector<Vec3> position;
  for (std::uint64_t i = 0; i < 299; ++i) {
    ASSERT_TRUE(rig.source->next(i, tick));
    position.push_back(tick.hand[1].position);
    EXPECT_TRUE(tick.hand[1].valid);
    EXPECT_EQ(tick.hand[1].buttons & clutchButton, 0);
  }
  EXPECT_EQ(position[199], position[100]);
  EXPECT_LT((position[202] - position[198]).norm(), 5e-5);  // goes on from where it stood
  EXPECT_NEAR((position[290] - position[210]).norm(), 0.8e-3, 1e-5);
}

TEST(DeviceSource, PracticePausesAndGoesOnWithoutAJump) {
  DeviceScript script = movingScript(400, 1, {Hand::right});
  script.unpluggings.push_back({150'000'000, 80'000'000});
  Rig rig(script, emptyScene());
  TickSamples tick;
  std::uint64_t i = 0, invalid = 0;
  Vec3 before = Vec3::Zero();
  while (rig.source->status() == SourceStatus::ok && i < 1000) {
    before = tick.hand[1].position;
    ASSERT_TRUE(rig.source->next(i++, tick));
    if (!tick.hand[1].valid) ++invalid;
  }
  EXPECT_EQ(i, 151U);
  EXPECT_EQ(invalid, 1U);
  EXPECT_EQ(tick.hand[1].position, before);  // held
  EXPECT_NE(rig.source->statusText().find("unplugged"), std::string::npos);
  int waits = 0;
  while (rig.source->status() == SourceStatus::paused && waits < 1000) ++waits;
  EXPECT_NEAR(waits, 78, 2);
  EXPECT_TRUE(rig.source->statusText().empty());
  ASSERT_TRUE(rig.source->next(i++, tick));
  EXPECT_TRUE(tick.hand[1].valid);
  EXPECT_LT((tick.hand[1].position - before).norm(), 5e-5);
  std::uint64_t rest = 0;
  while (rig.source->next(i++, tick)) ++rest;
  EXPECT_NEAR(static_cast<double>(rest), 250.0, 3.0);  // nothing of the script is lost
  EXPECT_EQ(rig.source->counts().losses, 1U);
}

TEST(DeviceSource, AssessmentFailsForGood) {
  DeviceScript script = movingScript(400, 1, {Hand::right});
  script.unpluggings.push_back({150'000'000, 3'000'000});
  DeviceSourceSettings settings;
  settings.mode = Mode::assessment;
  Rig rig(script, emptyScene(), settings);
  TickSamples tick;
  for (std::uint64_t i = 0; i < 160; ++i) ASSERT_TRUE(rig.source->next(i, tick));
  // It is back already, and the attempt has failed all the same.
  EXPECT_EQ(rig.source->status(), SourceStatus::failed);
  EXPECT_EQ(rig.source->status(), SourceStatus::failed);
  EXPECT_NE(rig.source->statusText().find("unplugged"), std::string::npos);
}

TEST(DeviceSource, WaitsForTheFirstSampleAndSaysWhatIsMissing) {
  DeviceScript script = movingScript(5, 1, {Hand::right});
  for (DeviceSample& s : script.samples) s.valid = false;
  Rig rig(script, emptyScene());
  expectFault(ErrorKind::failure, "", {"sample", "hand"}, [&] { rig.source->waitForFirst(0.1); });
}

TEST(DeviceSource, SaysWhatItIs) {
  DeviceScript script = movingScript(5, 1, {Hand::right});
  script.sha256 = "abc";
  const Rig scripted(script, emptyScene());
  EXPECT_EQ(scripted.source->provenance().kind, OperatorKind::performer);
  EXPECT_EQ(scripted.source->provenance().profile, "scripted");
  EXPECT_EQ(scripted.source->provenance().device, "scripted");
  EXPECT_EQ(scripted.source->provenance().sourceFile, "mover.json");
  EXPECT_EQ(scripted.source->provenance().sourceSha256, "abc");
  script.motionFile = true;
  const Rig motion(script, emptyScene());
  EXPECT_EQ(motion.source->provenance().kind, OperatorKind::kinematics);
}

TEST(DeviceSource, ForcesReachTheMotorsInTheDevicesFrame) {
  DeviceScript script = movingScript(100, 1, {Hand::right});
  script.maxForce = 4.0;
  const SceneDescription scene = emptyScene();
  Rig rig(script, scene);
  TickSamples tick;
  ASSERT_TRUE(rig.source->next(0, tick));
  std::array<Wrench, handCount> wrench;
  wrench[1].force = scene.camera.orientation * Vec3(0, 0, -2.0);
  rig.source->feedback(wrench);
  EXPECT_NEAR((rig.device->shown(Hand::right).force - Vec3(0, 0, -2.0)).norm(), 0.0, 1e-12);
  rig.clock->now += WrenchGate::watchdog;
  EXPECT_EQ(rig.device->shown(Hand::right).force, Vec3::Zero());
}

/// The whole way: device, loop, file, replay.
class DeviceRecording : public ::testing::TestWithParam<Mode> {};

TEST_P(DeviceRecording, UnpluggedInMidRunLosesNothing) {
  const std::filesystem::path assets = std::filesystem::path(CALOT_SOURCE_DIR) / "assets";
  LoadedScene scene = loadScene(findScene("touch-liver", {assets}));
  const Model::Built built = Model::build(scene.description);
  ASSERT_TRUE(built.model) << built.error;
  DeviceScript script = movingScript(600, 5, {Hand::right});
  script.unpluggings.push_back({304'000'000, 100'000'000});
  DeviceSourceSettings settings;
  settings.mode = GetParam();
  Rig rig(script, built.model->scene(), settings);
  rig.source->waitForFirst(1.0);
  AttemptSettings attempt;
  attempt.mode = GetParam();
  attempt.seed = 1;
  const AttemptHeader header = makeHeader(*built.model, std::move(scene.assets), rig.source->provenance(), attempt);
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("calot-device-" + std::to_string(getpid()) + ".h5");
  WorkerPool pool(1);
  RunReport report;
  {
    RecordingWriter writer(file, header, {true});
    Session session(*built.model, 1, pool);
    session.join(writer);
    report = runAttempt(session, *rig.source, RunSettings{});
    writer.finish();
  }
  if (GetParam() == Mode::assessment) {
    EXPECT_EQ(report.outcome, Outcome::technicalFailure);
    EXPECT_EQ(report.steps, 31U);  // the step in which it went is whole
  } else {
    EXPECT_EQ(report.outcome, Outcome::completed);
    EXPECT_EQ(report.pauses.count, 1U);
    EXPECT_NEAR(static_cast<double>(report.steps), 60.0, 1.0);
  }
  const ReplayReport replayed = replayRecording(file, ReplaySettings{});
  EXPECT_EQ(replayed.verdict, ReplayVerdict::exact) << replayed.error;
  EXPECT_TRUE(replayed.complete);
  EXPECT_EQ(replayed.outcome, report.outcome);
  EXPECT_EQ(replayed.steps, report.steps);
  std::filesystem::remove(file);
}

INSTANTIATE_TEST_SUITE_P(Modes, DeviceRecording, ::testing::Values(Mode::practice, Mode::assessment),
                         [](const auto& which) { return which.param == Mode::practice ? "practice" : "assessment"; });

TEST(DeviceSource, OnePressOfTheTriggerIsOneClip) {
  SceneDescription scene = emptyScene();
  for (const std::uint32_t ticksPerStep : {5U, 10U, 20U}) {
    scene.ticksPerStep = ticksPerStep;
    DeviceScript script = movingScript(1000, 1, {Hand::left, Hand::right});
    for (DeviceSample& s : script.samples) {
      const std::int64_t at = s.hostTime / 1'000'000;
      const bool shortly = at >= 101 && at < 104;
      const bool longly = at >= 300 && at < 700;
      if (s.hand == Hand::right && (shortly || longly)) s.buttons = button::fire | button::cutPedal;
    }
    Rig rig(script, scene);
    rig.source->waitForFirst(1.0);
    TickSamples tick;
    std::vector<std::uint64_t> seen, cutting;  // by steps, which take their newest sample
    for (std::uint64_t t = 0; t < 1000 && rig.source->next(t, tick); ++t) {
      EXPECT_EQ(tick.hand[0].buttons, 0U);
      if ((t + 1) % ticksPerStep != 0) continue;
      if ((tick.hand[1].buttons & button::fire) != 0) seen.push_back(t / ticksPerStep);
      if ((tick.hand[1].buttons & button::cutPedal) != 0) cutting.push_back(t);
    }
    ASSERT_EQ(seen.size(), 2U) << ticksPerStep;
    EXPECT_NEAR(static_cast<double>(seen[0] * ticksPerStep), 101.0, 2.0 * ticksPerStep);
    EXPECT_NEAR(static_cast<double>(seen[1] * ticksPerStep), 300.0, 2.0 * ticksPerStep);
    EXPECT_GE(cutting.size(), 390U / ticksPerStep) << "a pedal lasts as long as it is down";
  }
}

/// Samples of a hand whose jaws stood open by 0.6 rad and locked, from what its handle senses.
std::vector<InstrumentSample> takenOver(const std::vector<std::pair<double, std::uint8_t>>& sensed) {
  TakeOver takeOver({0.6, true});
  std::vector<InstrumentSample> out;
  for (const auto& [jaw, buttons] : sensed) {
    InstrumentSample& sample = out.emplace_back();
    sample.jaw = jaw;
    sample.buttons = buttons;
    takeOver.apply(sample);
  }
  return out;
}

TEST(TakeOver, ASensedJawTakesOverWhereItPassesTheOneThatIsKept) {
  const std::vector<InstrumentSample> opened = takenOver({{0.0, 0}, {0.3, 0}, {0.59, 0}, {0.61, 0}, {0.4, 0}});
  const double wanted[]{0.6, 0.6, 0.6, 0.61, 0.4};
  for (std::size_t i = 0; i < opened.size(); ++i) EXPECT_EQ(opened[i].jaw, wanted[i]) << i;
  const std::vector<InstrumentSample> closed = takenOver({{1.1, 0}, {0.9, 0}, {0.5, 0}, {0.7, 0}});
  const double wantedClosed[]{0.6, 0.6, 0.5, 0.7};
  for (std::size_t i = 0; i < closed.size(); ++i) EXPECT_EQ(closed[i].jaw, wantedClosed[i]) << i;
}

TEST(TakeOver, ALockIsKeptUntilTheDevicesIsTheSame) {
  const std::vector<InstrumentSample> out = takenOver({{0.0, 0}, {0.0, 0}, {0.0, button::lock}, {0.0, 0}});
  const bool wanted[]{true, true, true, false};
  for (std::size_t i = 0; i < out.size(); ++i) EXPECT_EQ((out[i].buttons & button::lock) != 0, wanted[i]) << i;
}

TEST(TakeOver, WhatIsDownCountsOnceItWasLetGo) {
  constexpr std::uint8_t down = button::cutPedal | button::fire | button::retractMore;
  const std::vector<InstrumentSample> out =
      takenOver({{0.0, down}, {0.0, down}, {0.0, button::fire}, {0.0, down}, {0.0, 0}, {0.0, button::fire}});
  const unsigned wanted[]{0, 0, 0, button::cutPedal | button::retractMore, 0, button::fire};
  for (std::size_t i = 0; i < out.size(); ++i) EXPECT_EQ(out[i].buttons & ~button::lock, wanted[i]) << i;
}

TEST(DeviceSource, ABranchActsOnlyWhenTheHandDoes) {
  const SceneDescription scene = emptyScene();
  DeviceScript still = movingScript(10'000, 1, {Hand::left, Hand::right});
  for (DeviceSample& s : still.samples) {
    s.position.setZero();
    s.buttons = button::coagulatePedal;
  }
  Rig rig(still, scene);
  devicetest::expectNothingActs(*rig.source, scene);
}

}  // namespace
}  // namespace calot::recorder::source_test
