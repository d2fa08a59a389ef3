// SPDX-License-Identifier: GPL-3.0-or-later
// Performers in closed loop: they do the task of each scene, by what they see, within what hands do.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "recorder/engine/session.h"
#include "recorder/formats/scene_file.h"
#include "recorder/sources/performer.h"
#include "sim/judgement/judge.h"
#include "sim/math/executor.h"
#include "tests/recorder/sources/support/test_scene.h"

namespace calot::recorder {
namespace {

namespace fs = std::filesystem;

const fs::path assets = fs::path(CALOT_SOURCE_DIR) / "assets";

PerformerProfile profileOf(const std::string& name) { return loadPerformer(assets / "performers" / (name + ".json")); }

std::unique_ptr<const Model> modelOf(const std::string& scene) {
  Model::Built built = Model::build(loadScene(assets / "scenes" / (scene + ".json")).description);
  EXPECT_EQ(built.error, "");
  return std::move(built.model);
}

/// What came of an attempt.
struct Attempt {
  Outcome outcome = Outcome::running;
  double seconds = 0.0;
  std::array<double, handCount> path{};  ///< of the simulated tips (m)
  StepResult last;
  std::uint32_t harmed = 0;  ///< injuries of vessels that must be spared
  std::uint32_t clips = 0;
  std::vector<TickSamples> samples;  ///< every 10th
  bool onGrid = true;
  std::uint32_t burnedWithoutCurrent = 0;               ///< events
  double fatAtFirst = 0.0, carvedWithoutCurrent = 0.0;  ///< m^3
  double cutPlace = 0.0;                                ///< of the last cut, from the vessel's start (m)
  std::vector<double> clipPlaces;                       ///< of all clips on any vessel, from its start (m)
};

Attempt perform(const Model& model, const PerformerProfile& profile, std::uint64_t seed, double seconds) {
  const std::unique_ptr<SampleSource> source = makePerformer(profile, model.scene(), seed);
  SerialExecutor executor;
  Session session(model, seed, executor);
  EXPECT_NE(source->watcher(), nullptr);
  session.join(*source->watcher());
  Attempt attempt;
  struct Watch final : Observer {
    Attempt& attempt;
    std::array<Vec3, handCount> before{Vec3::Zero(), Vec3::Zero()};
    bool first = true;
    Judge judge;
    Watch(Attempt& a, const SceneDescription& scene) : attempt(a), judge(scene) {}
    void onStep(const StepRecord& record) override {
      for (std::size_t h = 0; h < handCount; ++h) {
        const Vec3& tip = record.result.hand[h].tipSimulated;
        if (!first) attempt.path[h] += (tip - before[h]).norm();
        before[h] = tip;
      }
      first = false;
      bool current = false;
      for (const TickSamples& tick : record.samples) {
        current = current || (tick.hand[1].instrument == InstrumentKind::hook &&
                              (tick.hand[1].buttons & (button::cutPedal | button::coagulatePedal)) != 0);
      }
      for (const Event& event : record.result.events) {
        if (event.kind == EventKind::strandsBurned && !current) ++attempt.burnedWithoutCurrent;
        if (event.kind == EventKind::vesselCut) attempt.cutPlace = event.value;
      }
      for (const FatResult& fat : record.result.fat) {
        if (attempt.fatAtFirst == 0.0) attempt.fatAtFirst = fat.volume;
        if (!current) attempt.carvedWithoutCurrent += fat.carved;
      }
      attempt.last = record.result;
      attempt.harmed = 0;
      for (const AttemptError& error : judge.observe(record.result).errorList)
        attempt.harmed += error.rules.front() <= ErrorRule::sparedHeated ? 1U : 0U;
    }
    void onEnd(Outcome /*outcome*/) override {}
  } watch(attempt, model.scene());
  session.join(watch);
  const std::uint32_t ticksPerStep = model.scene().ticksPerStep;
  std::vector<TickSamples> samples(ticksPerStep);
  std::vector<TickOutcome> ticks(ticksPerStep);
  for (std::uint64_t tick = 0; static_cast<double>(tick) * tickLength < seconds;) {
    for (std::uint32_t i = 0; i < ticksPerStep; ++i, ++tick) {
      if (!source->next(tick, samples[i])) {
        attempt.outcome = source->ending();
        attempt.seconds = static_cast<double>(session.steps()) * model.stepSeconds();
        for (const BeamState& vessels : session.state().vessel) {
          attempt.clipPlaces.insert(attempt.clipPlaces.end(), vessels.clipPlace.begin(), vessels.clipPlace.end());
        }
        return attempt;
      }
      const TickSamples rounded = roundedToGrid(samples[i]);
      for (std::size_t h = 0; h < handCount; ++h) {
        attempt.onGrid = attempt.onGrid && rounded.hand[h].position == samples[i].hand[h].position &&
                         rounded.hand[h].orientation.coeffs() == samples[i].hand[h].orientation.coeffs() &&
                         rounded.hand[h].jaw == samples[i].hand[h].jaw;
      }
      ticks[i] = session.tick(samples[i]);
    }
    attempt.samples.push_back(samples[0]);
    session.step(samples, ticks, 0.0F);
  }
  attempt.seconds = seconds;
  return attempt;
}

Attempt perform(const Model& model, const std::string& profile, std::uint64_t seed, double seconds) {
  return perform(model, profileOf(profile), seed, seconds);
}

bool same(const TickSamples& a, const TickSamples& b) {
  for (std::size_t h = 0; h < handCount; ++h) {
    if (a.hand[h].position != b.hand[h].position || a.hand[h].jaw != b.hand[h].jaw ||
        a.hand[h].orientation.coeffs() != b.hand[h].orientation.coeffs() || a.hand[h].buttons != b.hand[h].buttons ||
        a.hand[h].instrument != b.hand[h].instrument) {
      return false;
    }
  }
  return true;
}

std::uint32_t clipsOf(const StepResult& result) {
  std::uint32_t clips = 0;
  for (const VesselResult& v : result.vessel) clips += v.clips;
  return clips;
}

void expectHuman(const Attempt& attempt) {
  const double mean = *std::max_element(attempt.path.begin(), attempt.path.end()) / attempt.seconds;
  EXPECT_GT(mean, 0.010);
  EXPECT_LT(mean, 0.080);
  EXPECT_TRUE(attempt.onGrid);
}

TEST(Operation, TheSceneSaysWhichPerformerItIs) {
  const PerformerProfile profile = profileOf("skilled");
  EXPECT_NE(dynamic_cast<PerformerSource*>(makePerformer(profile, test::roundScene(), 1).get()), nullptr);
  const SceneDescription scene = loadScene(assets / "scenes" / "clip-and-cut.json").description;
  EXPECT_NE(dynamic_cast<OperationSource*>(makePerformer(profile, scene, 1).get()), nullptr);
}

/// Nobody tells it of steps: it has seen nothing, and does nothing but tremble at home.
TEST(Operation, WhoSeesNothingRests) {
  const SceneDescription scene = loadScene(assets / "scenes" / "clip-and-cut.json").description;
  OperationSource source(profileOf("skilled"), scene, 1);
  TickSamples samples;
  for (std::uint64_t tick = 0; tick < 3000; ++tick) {
    ASSERT_TRUE(source.next(tick, samples));
    for (std::size_t h = 0; h < handCount; ++h) {
      EXPECT_LT((samples.hand[h].position - scene.hands[h].home).norm(), 0.002);
      EXPECT_EQ(samples.hand[h].buttons, 0);
    }
  }
}

class EachProfile : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Operation, EachProfile, testing::Values("skilled", "intermediate", "unskilled"),
                         [](const auto& tested) { return std::string(tested.param); });

TEST_P(EachProfile, ClipsAndCutsDuctAndArtery) {
  const std::unique_ptr<const Model> model = modelOf("clip-and-cut");
  ASSERT_TRUE(model);
  constexpr std::uint64_t seed = 2;
  RecordProperty("seed", seed);
  const Attempt attempt = perform(*model, GetParam(), seed, 200.0);
  EXPECT_EQ(attempt.outcome, Outcome::completed);
  EXPECT_GE(clipsOf(attempt.last), 6U);
  for (std::size_t v = 0; v < model->scene().vessels.size(); ++v) {
    const VesselDescription& vessel = model->scene().vessels[v];
    const bool divided = vessel.end.kind == VesselEndDescription::Kind::organ;
    EXPECT_EQ(attempt.last.vessel[v].partings, divided ? 1U : 0U) << vessel.name;
  }
  EXPECT_EQ(attempt.harmed, 0U);
  expectHuman(attempt);
}

/// The bed goes while the hook is in it under current, and at no other time.
TEST_P(EachProfile, FreesTheBedWithTheHook) {
  const std::unique_ptr<const Model> model = modelOf("dissect-bed");
  ASSERT_TRUE(model);
  constexpr std::uint64_t seed = 3;
  RecordProperty("seed", seed);
  const Attempt attempt = perform(*model, GetParam(), seed, 16.0);
  EXPECT_EQ(attempt.outcome, Outcome::running);
  EXPECT_GT(attempt.last.connective[0].burned, 0.03);
  EXPECT_LT(attempt.last.connective[0].torn, 0.1);
  EXPECT_EQ(attempt.burnedWithoutCurrent, 0U);
}

/// Vessels come free of fat and stay whole, with those that are to be spared; fat goes under current alone.
TEST(Operation, ClearsVesselsOfFat) {
  const std::unique_ptr<const Model> model = modelOf("carve-fat");
  ASSERT_TRUE(model);
  constexpr std::uint64_t seed = 1;
  RecordProperty("seed", seed);
  const Attempt attempt = perform(*model, "skilled", seed, 14.0);
  ASSERT_EQ(attempt.last.fat.size(), 1U);
  EXPECT_LT(attempt.last.fat[0].volume, 0.85 * attempt.fatAtFirst);
  EXPECT_EQ(attempt.carvedWithoutCurrent, 0.0);
  EXPECT_EQ(attempt.harmed, 0U);
  for (const VesselResult& vessel : attempt.last.vessel) EXPECT_EQ(vessel.partings, 0U);
}

/// Searches cost way and fat, and harm no vessel.
TEST(Operation, SearchesForAVesselCostWayAndFat) {
  const std::unique_ptr<const Model> model = modelOf("carve-fat");
  ASSERT_TRUE(model);
  PerformerProfile profile = profileOf("skilled");
  profile.operation.strokes = 1;
  profile.operation.window = 0;
  std::array<double, 2> path{}, fat{};
  for (const std::uint32_t searches : {0U, 4U}) {
    profile.operation.searches = searches;
    const Attempt attempt = perform(*model, profile, 1, 60.0);
    EXPECT_EQ(attempt.outcome, Outcome::completed);
    EXPECT_EQ(attempt.harmed, 0U);
    for (const VesselResult& vessel : attempt.last.vessel) EXPECT_EQ(vessel.partings, 0U);
    ASSERT_EQ(attempt.last.fat.size(), 1U);
    path[searches > 0 ? 1 : 0] = attempt.path[1];
    fat[searches > 0 ? 1 : 0] = attempt.last.fat[0].volume / attempt.fatAtFirst;
  }
  EXPECT_GT(path[1], path[0] + 0.2);
  EXPECT_LT(fat[1], fat[0] - 0.02);
}

/// A plane nearer to the liver spares the gallbladder; not in every attempt, but in three together.
TEST(Operation, SweepsOfTheBedKeepToTheirPlane) {
  const std::unique_ptr<const Model> model = modelOf("dissect-bed");
  ASSERT_TRUE(model);
  const std::vector<OrganDescription>& organs = model->scene().organs;
  const auto gallbladder = static_cast<std::size_t>(
      std::find_if(organs.begin(), organs.end(), [](const auto& o) { return o.name == "gallbladder"; }) -
      organs.begin());
  ASSERT_LT(gallbladder, organs.size());
  const auto charred = [&](double plane) {
    PerformerProfile profile = profileOf("skilled");
    profile.operation.plane = plane;
    double sum = 0.0;
    for (const std::uint64_t seed : {1U, 2U, 3U})
      sum += perform(*model, profile, seed, 12.0).last.organ[gallbladder].charredArea;
    return sum;
  };
  EXPECT_LT(charred(0.6), 0.8 * charred(0.4));
}

/// Who anticipates looks while a stroke is still under way, and never before the last one has begun.
TEST(Operation, AHandKnowsWhenItWillBeIdle) {
  const HandDescription description = test::roundScene().hands[0];
  PerformerHand hand(profileOf("skilled"), description, 0, 7);
  HandMove move, back;
  move.to = description.home + Vec3(0.0, 0.0, 0.01);
  move.speed = 0.01;
  move.sure = true;
  back = move;
  back.to = description.home;
  hand.add(move);
  hand.add(back);
  EXPECT_FALSE(hand.idleIn(100.0, 0.0));
  double began = -1.0, ended = -1.0;
  for (int tick = 0; tick < 3000 && ended < 0.0; ++tick) {
    const double time = tick * tickLength;
    hand.sample(time);
    if (began < 0.0 && hand.waiting() == 0) began = time;
    if (hand.idle(time)) ended = time;
    if (began < 0.0) {
      EXPECT_FALSE(hand.idleIn(100.0, time));
    }
  }
  ASSERT_GT(ended, began);
  PerformerHand again(profileOf("skilled"), description, 0, 7);
  again.add(move);
  again.add(back);
  for (int tick = 0; tick * tickLength < ended - 0.1; ++tick) again.sample(tick * tickLength);
  EXPECT_TRUE(again.idleIn(0.11, ended - 0.1));
  EXPECT_FALSE(again.idleIn(0.09, ended - 0.1));
}

/// What is to be divided, and with how many clips, is the scene's to say.
TEST(Operation, DoesWhatTheProcedureAsksFor) {
  SceneDescription scene = loadScene(assets / "scenes" / "clip-and-cut.json").description;
  scene.procedure.divide = {{"cystic-artery", 1, 2, true}};
  const Model::Built built = Model::build(scene);
  ASSERT_TRUE(built.model) << built.error;
  const Attempt attempt = perform(*built.model, "skilled", 4, 90.0);
  EXPECT_EQ(attempt.outcome, Outcome::completed);
  ASSERT_GT(attempt.cutPlace, 0.0);
  std::array<std::uint32_t, 2> clips{0, 0};
  for (const double place : attempt.clipPlaces) ++clips[place < attempt.cutPlace ? 0 : 1];
  EXPECT_EQ(clips[0], 1U);
  EXPECT_EQ(clips[1], 2U);
  for (std::size_t v = 0; v < scene.vessels.size(); ++v) {
    const bool asked = scene.vessels[v].name == "cystic-artery";
    EXPECT_EQ(attempt.last.vessel[v].clips, asked ? 3U : 0U) << scene.vessels[v].name;
    EXPECT_EQ(attempt.last.vessel[v].partings, asked ? 1U : 0U) << scene.vessels[v].name;
  }
}

TEST(Operation, IsGivenUpWhenPatienceIsOver) {
  const std::unique_ptr<const Model> model = modelOf("clip-and-cut");
  ASSERT_TRUE(model);
  PerformerProfile profile = profileOf("skilled");
  profile.operation.patience = 10.0;
  const Attempt attempt = perform(*model, profile, 1, 60.0);
  EXPECT_EQ(attempt.outcome, Outcome::abandoned);
  EXPECT_GE(attempt.seconds, 10.0);
  EXPECT_LT(attempt.seconds, 20.0);
}

TEST(Operation, TheSameSeedGivesTheSameSamplesAnotherOneOthers) {
  const std::unique_ptr<const Model> model = modelOf("clip-and-cut");
  ASSERT_TRUE(model);
  const Attempt a = perform(*model, "unskilled", 5, 8.0);
  const Attempt b = perform(*model, "unskilled", 5, 8.0);
  const Attempt c = perform(*model, "unskilled", 6, 8.0);
  ASSERT_EQ(a.samples.size(), b.samples.size());
  EXPECT_TRUE(std::equal(a.samples.begin(), a.samples.end(), b.samples.begin(), same));
  EXPECT_FALSE(std::equal(a.samples.begin(), a.samples.end(), c.samples.begin(), same));
}

/// Tremor of a hand at rest: its amplitude is the profile's, and it lies in its band.
TEST(Operation, HandsTrembleAsTheirProfileSays) {
  for (const char* name : {"skilled", "intermediate", "unskilled"}) {
    PerformerProfile profile = profileOf(name);
    EXPECT_GE(profile.motor.tremorLower, 8.0);
    EXPECT_LE(profile.motor.tremorUpper, 12.0);
    EXPECT_GE(profile.motor.tremorAmplitude, 0.00005);
    EXPECT_LE(profile.motor.tremorAmplitude, 0.0002);
    profile.motor.wanderAmplitude = 0.0;
    const HandDescription description = test::roundScene().hands[0];
    double power = 0.0;
    int crossings = 0, count = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      PerformerHand hand(profile, description, 0, seed);
      double before = 0.0;
      for (int tick = 0; tick < 6000; ++tick) {
        const double x = (hand.sample(tick * tickLength).position - description.home).x();
        if (tick < 1000) continue;
        power += x * x;
        ++count;
        if (before * x < 0.0) ++crossings;
        before = x;
      }
    }
    EXPECT_NEAR(std::sqrt(power / count), profile.motor.tremorAmplitude, 0.15 * profile.motor.tremorAmplitude) << name;
    const double hertz = 0.5 * crossings / (count * tickLength);
    EXPECT_GT(hertz, 8.0) << name;
    EXPECT_LT(hertz, 12.0) << name;
  }
}

/// The whole operation: minutes for each attempt. Run where CALOT_HEAVY is set.
class OperationHeavy : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Profiles, OperationHeavy, testing::Values("skilled", "intermediate", "unskilled"),
                         [](const auto& tested) { return std::string(tested.param); });

TEST_P(OperationHeavy, CompletesTheWholeOperationAsOftenAsItShould) {
  if (std::getenv("CALOT_HEAVY") == nullptr) GTEST_SKIP() << "CALOT_HEAVY is not set";
  const std::unique_ptr<const Model> model = modelOf("cholecystectomy");
  ASSERT_TRUE(model);
  const std::string profile = GetParam();
  const int wanted = profile == "skilled" ? 19 : profile == "intermediate" ? 18 : 16;
  int completed = 0;
  double seconds = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Attempt attempt = perform(*model, profile, seed, 1200.0);
    EXPECT_NE(attempt.outcome, Outcome::running) << "seed " << seed;
    const bool free = attempt.last.connective[0].attached == 0.0;
    const bool divided = attempt.last.vessel[2].partings > 0 && attempt.last.vessel[4].partings > 0;
    const bool whole = free && divided && clipsOf(attempt.last) >= 2;
    if (attempt.outcome == Outcome::completed) {
      EXPECT_TRUE(whole) << "seed " << seed;
      ++completed;
      seconds += attempt.seconds;
    }
    std::cout << profile << " seed " << seed << ": outcome " << static_cast<int>(attempt.outcome) << " after "
              << attempt.seconds << " s\n";
    expectHuman(attempt);
  }
  EXPECT_GE(completed, wanted);
  // An operation is to take 30 to 180 s; who searches for the vessels takes longer.
  EXPECT_GT(seconds, 30.0 * completed);
  EXPECT_LT(seconds, (profile == "unskilled" ? 240.0 : profile == "intermediate" ? 200.0 : 180.0) * completed);
}

}  // namespace
}  // namespace calot::recorder
