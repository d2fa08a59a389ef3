// SPDX-License-Identifier: GPL-3.0-or-later
// Verification in segments says what a run from the start says.
#include "recorder/verification.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "recorder/base/errors.h"
#include "recorder/replay.h"
#include "tests/recorder/support/lying_recording.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

using test::Lie;

ReplayReport verified(const std::filesystem::path& file, unsigned threads) {
  ReplaySettings settings;
  settings.threads = threads;
  return replayRecording(file, settings);
}

void expectSame(const ReplayReport& serial, const ReplayReport& parallel) {
  EXPECT_EQ(serial.verdict, parallel.verdict);
  EXPECT_EQ(serial.finding, parallel.finding);
  EXPECT_EQ(serial.chain, parallel.chain);
  EXPECT_EQ(serial.divergence, parallel.divergence);
  EXPECT_EQ(serial.reproducible, parallel.reproducible);
  EXPECT_EQ(serial.misses, parallel.misses);
  EXPECT_EQ(serial.steps, parallel.steps);
  EXPECT_EQ(serial.outcome, parallel.outcome);
  EXPECT_EQ(serial.chainHead, parallel.chainHead);
}

TEST(Segments, CoverEveryStepOnce) {
  const test::Folder folder;
  test::recordTouches(folder / "r.h5");
  const Recording recording(folder / "r.h5");
  const std::vector<Segment> expected{{0, 100, {}}, {100, 200, 0}, {200, 210, 1}};
  EXPECT_EQ(segmentsOf(recording), expected);
}

/// Steps at both ends of segments and within them, and every kind of data that is compared.
TEST(Segments, NameTheFirstDifferenceThatARunFromTheStartNames) {
  const test::Folder folder;
  int number = 0;
  const auto check = [&](const std::optional<Lie>& lie) {
    const std::filesystem::path file = folder / (std::to_string(number++) + ".h5");
    test::recordTouches(file, lie);
    const ReplayReport serial = verified(file, 1);
    EXPECT_EQ(serial.verdict, lie ? ReplayVerdict::diverged : ReplayVerdict::exact) << serial.error;
    SCOPED_TRACE(serial.error);
    expectSame(serial, verified(file, 3));
    std::filesystem::remove(file);
  };
  check(std::nullopt);
  using About = Lie::About;
  // Each kind at one of the steps, in turn; all of them in the long form.
  const bool all = std::getenv("CALOT_HEAVY") != nullptr;
  std::size_t turn = 0;
  for (const About about :
       {About::force, About::torque, About::contactSet, About::sample, About::digest, About::volume, About::event}) {
    ++turn;
    for (const std::uint64_t step : {99U, 100U, 207U}) {
      if (!all && (step == 99U ? 0U : step == 100U ? 1U : 2U) != turn % 3) continue;
      SCOPED_TRACE("lie " + std::to_string(static_cast<int>(about)) + " at step " + std::to_string(step));
      check(Lie{about, step});
    }
  }
  for (const About about : {About::keyframe, About::lastByte}) {
    for (const std::uint64_t step : {99U, 199U}) {
      if (!all && (about == About::keyframe) != (step == 99U)) continue;
      SCOPED_TRACE("lie " + std::to_string(static_cast<int>(about)) + " at step " + std::to_string(step));
      check(Lie{about, step});
    }
  }
}

/// With as many threads as a workstation has, too: one byte, the very last of a keyframe.
TEST(Segments, FindAFaultInTheLastByteOfAKeyframe) {
  const test::Folder folder;
  for (const std::uint64_t step : {99U, 199U}) {
    const std::filesystem::path file = folder / (std::to_string(step) + ".h5");
    test::recordTouches(file, Lie{Lie::About::lastByte, step});
    const ReplayReport report = verified(file, 8);
    EXPECT_EQ(report.verdict, ReplayVerdict::diverged);
    EXPECT_TRUE(report.chainIntact());
    ASSERT_TRUE(report.divergence);
    EXPECT_EQ(report.divergence->step, step);
    EXPECT_EQ(report.divergence->component, "keyframe");
    EXPECT_EQ(report.divergence->field, "haptics");
    expectSame(verified(file, 1), report);
  }
}

/// They get what was recorded once it is proven, in order, with all that a run would have shown them.
TEST(Segments, ObserversSeeTheStepsOfARun) {
  const test::Folder folder;
  test::recordTouches(folder / "r.h5");
  struct Watch final : Observer {
    std::vector<StepResult> results;
    std::vector<Vec3> forces, positions;
    Outcome outcome = Outcome::running;
    void onStep(const StepRecord& record) override {
      ASSERT_EQ(record.step, results.size());
      results.push_back(record.result);
      for (const TickOutcome& tick : record.ticks) forces.push_back(tick.hand[1].force);
      for (const TickSamples& tick : record.samples) positions.push_back(tick.hand[0].position);
    }
    void onEnd(Outcome end) override { outcome = end; }
  };
  std::array<Watch, 2> watch;
  for (const unsigned threads : {1U, 2U}) {
    ReplaySettings settings;
    settings.threads = threads;
    settings.observers = [&](const AttemptHeader&, const SceneDescription&) {
      return std::vector<Observer*>{&watch[threads - 1]};
    };
    EXPECT_EQ(replayRecording(folder / "r.h5", settings).verdict, ReplayVerdict::exact);
  }
  EXPECT_EQ(watch[0].results.size(), 210U);
  ASSERT_EQ(watch[1].results.size(), 210U);
  ResultComparison differ(Recording(folder / "r.h5").header());
  for (std::size_t n = 0; n < 210; ++n) {
    EXPECT_FALSE(differ(watch[0].results[n], watch[1].results[n])) << "step " << n;
  }
  EXPECT_EQ(watch[0].forces, watch[1].forces);
  EXPECT_EQ(watch[0].positions, watch[1].positions);
  EXPECT_EQ(watch[1].outcome, Outcome::stopped);
}

TEST(Segments, ObserversSeeNothingOfWhatIsNotProven) {
  const test::Folder folder;
  test::recordTouches(folder / "r.h5", Lie{Lie::About::force, 205});
  struct Watch final : Observer {
    int calls = 0;
    void onStep(const StepRecord& /*record*/) override { ++calls; }
    void onEnd(Outcome /*outcome*/) override { ++calls; }
  } watch;
  ReplaySettings settings;
  settings.threads = 2;
  settings.observers = [&](const AttemptHeader&, const SceneDescription&) { return std::vector<Observer*>{&watch}; };
  EXPECT_EQ(replayRecording(folder / "r.h5", settings).verdict, ReplayVerdict::diverged);
  EXPECT_EQ(watch.calls, 0);
}

TEST(Segments, ProgressCountsEveryStepAndComesToTheCaller) {
  const test::Folder folder;
  test::recordTouches(folder / "r.h5");
  const std::thread::id here = std::this_thread::get_id();
  std::uint64_t last = 0;
  ReplaySettings settings;
  settings.threads = 3;
  settings.progress = [&](std::uint64_t step, std::uint64_t of) {
    EXPECT_EQ(std::this_thread::get_id(), here);
    EXPECT_GE(step, last);
    EXPECT_EQ(of, 210U);
    last = step;
  };
  replayRecording(folder / "r.h5", settings);
  EXPECT_EQ(last, 210U);
}

/// A part is consistent, never exact; what is wrong elsewhere is not its affair.
TEST(Segments, APartIsConsistentWithTheKeyframeBeforeIt) {
  const test::Folder folder;
  test::recordTouches(folder / "r.h5", Lie{Lie::About::force, 205});
  const auto part = [&](std::size_t first, std::size_t last) {
    ReplaySettings settings;
    settings.part.emplace(first, last);
    return replayRecording(folder / "r.h5", settings);
  };
  const ReplayReport good = part(0, 1);
  EXPECT_EQ(good.verdict, ReplayVerdict::consistent);
  ASSERT_TRUE(good.part);
  EXPECT_EQ(good.part->segments, (std::array<std::size_t, 2>{0, 1}));
  EXPECT_EQ(good.part->steps, (std::array<std::uint64_t, 2>{0, 199}));
  EXPECT_EQ(good.fault(), std::nullopt);
  EXPECT_EQ(good.misses.steps, 200U);
  const ReplayReport bad = part(2, 2);
  EXPECT_EQ(bad.verdict, ReplayVerdict::diverged);
  ASSERT_TRUE(bad.divergence);
  EXPECT_EQ(bad.divergence->step, 205U);
  EXPECT_THROW(part(1, 3), Error);
  EXPECT_THROW(part(2, 1), Error);
}

/// What cannot be read is told as it is from a run, in whichever segment it lies.
TEST(Segments, AreOfARecordingThatCanBeRead) {
  const test::Folder folder;
  const std::filesystem::path file = folder / "r.h5";
  test::recordTouches(file);
  const Recording recording(file);
  const EngineChoice choice(recording, {});
  EXPECT_THROW(verifySegments(file, choice, {}, 2), std::invalid_argument);
  EXPECT_THROW(verifySegments(folder / "none.h5", choice, segmentsOf(recording), 2), Error);
  const SegmentsVerdict part = verifySegments(file, choice, {segmentsOf(recording)[1]}, 2);
  EXPECT_FALSE(part.divergence);
  EXPECT_EQ(part.misses.steps, 100U);
}

}  // namespace
}  // namespace calot::recorder
