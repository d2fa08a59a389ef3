// SPDX-License-Identifier: GPL-3.0-or-later
// Damage for work done, contact with what is to be spared, and the figures of single phases: over steps made by hand
// with known answers, and by the law that the phase of an attempt that has only one is the whole attempt.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>

#include "analytics/checkpoints/checkpoint.h"
#include "tests/analytics/checkpoints/support/operation.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using recorder::Outcome;
using namespace support;

SceneDescription sparingScene() {
  SceneDescription s = operationScene();
  s.procedure.specimen = "organ-b";
  s.procedure.spare = {"v1", "v3"};
  return s;
}

/// Char on the first organ (cm^2) and fat taken (ml) in one step of a phase.
void burn(Operation& o, Phase phase, double charred, double taken) {
  o.judged.phase = phase;
  o.now.organ[0].charredArea += charred * 1e-4;
  o.now.fat[0].volume -= taken * 1e-6;
  o.step();
}

TEST(SceneFacts, theBedIsWhatLiesWithinReach) {
  SceneDescription s = operationScene();
  EXPECT_DOUBLE_EQ(sceneFacts(s).connective.at(0).area, 0.005) << "one skin on the other";
  for (Vec3& p : s.organs[1].surface.vertex) p.z() += 0.003;
  EXPECT_DOUBLE_EQ(sceneFacts(s).connective.at(0).area, 0.005) << "3 mm, and 4 mm of reach";
  s.organs[1].surface.vertex[2].z() += 0.002;
  EXPECT_EQ(sceneFacts(s).connective.at(0).area, 0.0) << "a corner is out of reach";
}

TEST(BurnPerFat, isOfIdentificationAlone) {
  Operation o;
  o.step();
  burn(o, Phase::identification, 0.1, 0.05);
  expectNotApplicable(o.value("burn-per-fat"), {"1 %", "fat", "phase"});
  burn(o, Phase::identification, 0.1, 0.95);
  burn(o, Phase::clipping, 0.4, 0.0);
  burn(o, Phase::identification, 0.1, 1.0);  // the phase recurs
  burn(o, Phase::dissection, 0.8, 2.0);
  o.end();
  EXPECT_NEAR(*o.value("burn-per-fat").value, 0.3e-4 / 2.0e-6, 1e-9);
  const CheckpointDefinition& d = *findCheckpoint("burn-per-fat");
  EXPECT_NEAR(*o.value("burn-per-fat").value * d.displayFactor, 0.15, 1e-12) << "cm^2/ml";
  EXPECT_NEAR(*o.value("phase-charred-area", "identification").value, 0.3e-4, 1e-15);
  EXPECT_NEAR(*o.value("phase-charred-area", "clipping").value, 0.4e-4, 1e-15);
  EXPECT_NEAR(*o.value("phase-charred-area", "dissection").value, 0.8e-4, 1e-15);
  expectNotApplicable(o.value("phase-charred-area", "cutting"), {"phase"});
  SceneDescription scene = operationScene();
  scene.fat.clear();
  Operation without(scene);
  without.now.fat.clear();
  without.step();
  without.end();
  expectNotApplicable(without.value("burn-per-fat"), {"fat"});
}

TEST(BurnPerDissection, isPerAreaThatCameFreeInDissection) {
  Operation o;
  o.step();
  const auto free = [&](Phase phase, double attached, double charred) {
    o.judged.phase = phase;
    o.now.connective[0].attached = attached;
    o.now.connective[0].burned = 1.0 - attached;
    o.now.organ[1].charredArea += charred;
    o.step();
  };
  free(Phase::identification, 0.8, 3e-5);  // the lower third, before the first clip
  free(Phase::dissection, 0.795, 0.0);
  expectNotApplicable(o.value("burn-per-dissection"), {"1 %", "bed", "phase"});
  free(Phase::dissection, 0.3, 1e-5);
  o.end();
  EXPECT_NEAR(*o.value("burn-per-dissection").value, 1e-5 / (0.5 * 0.005), 1e-12);
  EXPECT_NEAR(*o.value("burn-per-bed").value, 4e-5 / 0.7, 1e-12) << "which charges all of it to the bed";
}

TEST(BurnPerWork, ofStepsThatDoNotBeginWithTheFirstIsOfWhatIsSeen) {
  Operation o;
  o.next = 500;  // a part of an attempt: what was charred before is not of these steps
  burn(o, Phase::identification, 5.0, 0.0);
  burn(o, Phase::identification, 0.1, 1.0);
  o.end();
  EXPECT_NEAR(*o.value("burn-per-fat").value, 0.1e-4 / 1e-6, 1e-9);
}

TEST(SparedContact, bothReadings) {
  Operation o(sparingScene());
  const auto touch = [&](std::uint32_t left, std::uint32_t right, std::uint64_t steps) {
    o.now.hand[0].touching = left;
    o.now.hand[1].touching = right;
    o.steps(steps);
  };
  const std::uint32_t duct = 1U << bileDuct, artery = 1U << hepaticArtery;
  const std::uint32_t others = 1U << liver | 1U << gallbladder | 1U << cysticDuct | 1U << cysticArtery | 1U << fat;
  touch(others, others, 50);
  touch(duct, others, 10);
  touch(duct | artery, artery, 20);
  o.end();
  EXPECT_DOUBLE_EQ(*o.value("spared-contact-time-union").value, 0.3);
  EXPECT_DOUBLE_EQ(*o.value("spared-contact-time-sum").value, 0.1 + 3 * 0.2);
  EXPECT_EQ(o.value("spared-contact-time-sum").note, "v1 0.30 s, v3 0.40 s");
  Operation none;
  none.step();
  none.end();
  expectNotApplicable(none.value("spared-contact-time-union"), {"vessel"});
  CheckpointCollector plain(header(), scene());
  feed(plain, 1, [](std::uint64_t, TickSamples&, recorder::TickOutcome&) {});
  expectNotApplicable(valueOf(plain, "spared-contact-time-sum"), {"procedure"});
}

TEST(PhaseFigures, contactAndCurrentAreThoseOfThePhasesSteps) {
  Operation o;
  o.now.hand[1].instrument = InstrumentKind::hook;
  const auto go = [&](Phase phase, std::uint32_t touching, Cautery cautery, std::uint64_t steps) {
    o.judged.phase = phase;
    o.now.hand[1].touching = touching;
    o.now.hand[1].cautery = cautery;
    o.steps(steps);
  };
  const std::uint32_t duct = 1U << cysticDuct;
  go(Phase::identification, duct, Cautery::withoutContact, 15);
  go(Phase::clipping, duct, Cautery::withoutContact, 9);  // goes on, too short in this phase
  go(Phase::identification, 0, Cautery::withoutContact, 5);
  go(Phase::identification, 0, Cautery::off, 5);
  o.end();
  EXPECT_DOUBLE_EQ(*o.value("phase-cystic-contact-time", "identification").value, 0.15);
  EXPECT_DOUBLE_EQ(*o.value("phase-cystic-contact-time", "clipping").value, 0.09);
  expectNotApplicable(o.value("phase-cystic-contact-time", "cutting"), {"phase"});
  EXPECT_DOUBLE_EQ(*o.value("phase-cautery-without-contact", "right identification").value, 0.15);
  EXPECT_EQ(*o.value("phase-cautery-without-contact", "right clipping").value, 0.0);
  expectNotApplicable(o.value("phase-cautery-without-contact", "left clipping"), {"hook"});
  EXPECT_DOUBLE_EQ(*o.value("cautery-without-contact", "right").value, 0.29) << "one stretch over three phases";
}

TEST(PhaseFigures, forcesAreThoseOfThePhasesTicks) {
  CheckpointCollector collector(header(), sceneWithProcedure());
  // 2 N for 3 s of identification, 5 N for 1 s of clipping, 1 N for 1 s of identification again.
  const auto newtons = [](std::uint64_t tick) { return tick < 3000 ? 2.0 : tick < 4000 ? 5.0 : 1.0; };
  feedPhases(
      collector, 500,
      [&](std::uint64_t tick, TickSamples&, recorder::TickOutcome& o) {
        o.hand[0].force = Vec3(0.0, newtons(tick), 0.0);
      },
      [](std::uint64_t step) { return step >= 300 && step < 400 ? Phase::clipping : Phase::identification; });
  collector.onEnd(Outcome::completed);
  const auto number = [&](const char* name, const char* subject) { return *valueOf(collector, name, subject).value; };
  EXPECT_EQ(number("phase-force-maximum", "left identification"), 2.0);
  EXPECT_EQ(number("phase-force-maximum", "left clipping"), 5.0);
  EXPECT_EQ(number("phase-force-p99", "left clipping"), 5.0);
  EXPECT_NEAR(number("phase-force-impulse", "left identification"), 7.0, 1e-9);
  EXPECT_NEAR(number("phase-force-impulse", "left clipping"), 5.0, 1e-9);
  EXPECT_EQ(number("phase-force-impulse", "right clipping"), 0.0);
  expectNotApplicable(valueOf(collector, "phase-force-p99", "right clipping"), {"0.01 N"});
  expectNotApplicable(valueOf(collector, "phase-force-maximum", "left cutting"), {"phase"});
}

/// An attempt that is dissection from its first step to its last: random motion, forces, contact and current.
TEST(PhaseFigures, ofTheOnlyPhaseAreThoseOfTheWholeAttempt) {
  const unsigned seed = 20260101;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const auto draw = [&] { return std::uniform_real_distribution<double>(-1.0, 1.0)(random); };
  CheckpointCollector collector(operationHeader(), operationScene());
  std::array<Vec3, 2> place{Vec3::Zero(), Vec3::Zero()};
  StepResult result;
  result.organ.resize(2);
  result.vessel.resize(4);
  result.fat.resize(1);
  result.connective.resize(1);
  Judgement judged;
  judged.phase = Phase::dissection;
  result.hand[1].instrument = InstrumentKind::hook;
  for (std::uint64_t step = 0; step < 1000; ++step) {
    std::vector<TickSamples> samples(10);
    std::vector<recorder::TickOutcome> ticks(10);
    for (std::size_t t = 0; t < samples.size(); ++t) {
      for (std::size_t h = 0; h < 2; ++h) {
        for (int axis = 0; axis < 3; ++axis) place[h][axis] = 0.999 * place[h][axis] + 0.0005 * draw();
        samples[t].hand[h].instrument = h == 0 ? InstrumentKind::grasper : InstrumentKind::hook;
        samples[t].hand[h].position = place[h];
        const double turn = 5.0 * place[h].x();
        samples[t].hand[h].orientation = Quat(std::cos(turn), 0.0, std::sin(turn), 0.0);
        ticks[t].hand[h].force = 100.0 * place[h];
      }
    }
    result.step = step;
    result.hand[1].touching = draw() > 0.0 ? 1U << cysticDuct : 0U;
    result.hand[1].cautery = step % 50 < 20 ? Cautery::withoutContact : Cautery::off;
    const StateDigest digest;
    collector.take({step, samples, ticks, result, digest, 0.0F, {}, {}}, judged);
  }
  collector.onEnd(Outcome::completed);
  std::size_t compared = 0;
  for (const std::string& name : phaseCheckpoints()) {
    const CheckpointDefinition* whole = findCheckpoint(name.substr(std::string("phase-").size()));
    if (whole == nullptr) continue;  // phase-duration, phase-charred-area: a phase's alone
    const CheckpointDefinition& phase = *findCheckpoint(name);
    EXPECT_EQ(phase.unit, whole->unit) << name;
    EXPECT_EQ(phase.direction, whole->direction) << name;
    EXPECT_EQ(phase.filter, whole->filter) << name;
    const bool hands = phase.aggregation == Aggregation::handAndPhase;
    for (const std::string hand : {"left", "right"}) {
      const CheckpointValue of = valueOf(collector, name, hands ? hand + " dissection" : "dissection");
      const CheckpointValue all = valueOf(collector, whole->name, hands ? hand : "");
      EXPECT_EQ(of.value, all.value) << name << ' ' << hand;
      EXPECT_EQ(of.reason, all.reason) << name << ' ' << hand;
      compared += of.value ? 1 : 0;
    }
  }
  EXPECT_GE(compared, 25U);
}

}  // namespace
}  // namespace calot::analytics
