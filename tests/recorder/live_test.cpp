// SPDX-License-Identifier: GPL-3.0-or-later
// The two loops of a live run: whatever the machine did in between, the recording replays bit for bit.
#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>

#include "recorder/loop.h"
#include "recorder/recording/writer.h"
#include "recorder/replay.h"
#include "tests/recorder/support/rerun.h"
#include "tests/recorder/support/small_scene.h"

namespace calot::recorder {
namespace {

using std::chrono::milliseconds;

struct Recorded {
  RunReport report;
  std::filesystem::path file;
};

/// Records on a simulation that waits as `wait` says.
Recorded record(const test::SmallScene& scene, SampleSource& source, const std::filesystem::path& file,
                const RunSettings& run, std::function<void(std::uint64_t)> wait) {
  AttemptSettings settings;
  settings.seed = 4;
  RecordingWriter writer(file, makeHeader(*scene.model, scene.assets, source.provenance(), settings));
  test::SlowMachine slow(std::move(wait));
  SerialExecutor executor;
  Session session(*scene.model, 4, executor);
  session.join(writer);
  session.join(slow);
  Recorded recorded{runAttempt(session, source, run), file};
  writer.finish();
  return recorded;
}

struct Looked {
  std::int64_t oldestSet = 0;  ///< largest n - 1 - number of the set that a tick of step n used
  double stretched = 0.0;      ///< by the events
  double lateness = 0.0;       ///< what the ticks' lateness exceeds maxLag by
  std::uint64_t events = 0, missed = 0;
  std::uint64_t firm = 0;  ///< ticks with a force
};

Looked lookInto(Recording& recording) {
  Looked seen;
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    const RecordedStep& step = recording.step(n);
    for (const TickOutcome& tick : step.ticks) {
      for (const HandTick& hand : tick.hand) {
        seen.oldestSet = std::max(seen.oldestSet, static_cast<std::int64_t>(n) - 1 - hand.contactSet);
        if (hand.force.norm() > 0.0) ++seen.firm;
      }
      if (tick.lateness > maxLag) seen.lateness += static_cast<double>(tick.lateness) - static_cast<double>(maxLag);
      if (tick.lateness > tickDeadline) ++seen.missed;
    }
    for (const Event& event : step.result.events) {
      if (event.kind != EventKind::clockStretched) continue;
      ++seen.events;
      seen.stretched += event.value;
      EXPECT_EQ(event.step, n);
    }
  }
  return seen;
}

void expectExact(const std::filesystem::path& file) {
  for (const unsigned threads : {1U, 2U}) {
    ReplaySettings settings;
    settings.threads = threads;
    const ReplayReport report = replayRecording(file, settings);
    EXPECT_EQ(report.verdict, ReplayVerdict::exact) << report.error;
    EXPECT_TRUE(report.complete);
  }
}

TEST(Live, ASlowSimulationReplaysAndCanBeSoughtIn) {
  const test::SmallScene scene = test::smallScene();
  const test::Folder folder;
  const std::unique_ptr<SampleSource> source = test::performer(scene, "skilled", 5);
  RunSettings run;
  run.live = true;
  run.seconds = 2.3;
  const Recorded recorded = record(scene, *source, folder / "slow.h5", run, [](std::uint64_t step) {
    // Much too slow for most of the time, then quick enough to catch up.
    if (step < 150) std::this_thread::sleep_for(milliseconds(25));
  });
  EXPECT_EQ(recorded.report.outcome, Outcome::stopped);
  EXPECT_EQ(recorded.report.disagreements, 0U);
  EXPECT_EQ(recorded.report.steps, 230U);
  EXPECT_EQ(recorded.report.ticks, 2300U);
  expectExact(recorded.file);

  Recording recording(recorded.file);
  const Looked seen = lookInto(recording);
  EXPECT_GE(seen.oldestSet, 5) << "no tick used an old contact set";
  EXPECT_LT(seen.oldestSet, static_cast<std::int64_t>(Session::keptSets));
  EXPECT_GT(seen.firm, 100U) << "nothing was touched";
  EXPECT_GT(seen.events, 0U);
  EXPECT_NEAR(seen.stretched, seen.lateness, 1e-9);
  EXPECT_NEAR(seen.stretched, recorded.report.stretched, 1e-4);
  EXPECT_EQ(seen.missed, recorded.report.missedDeadlines);

  // Seeking from keyframes gives the state, forces and keyframes of running there.
  ASSERT_EQ(recording.keyframeSteps(), (std::vector<std::uint64_t>{99, 199}));
  SerialExecutor executor;
  const std::shared_ptr<PreparedScene> prepared = sceneOf(recording);
  const Model& model = prepared->model();
  Session straight(model, recording.header().seed, executor);
  std::vector<Keyframe> frames;
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    test::rerun(straight, recording.step(n));
    frames.push_back(straight.keyframe());
  }
  Seeker seeker(recording);
  for (const std::uint64_t step : {199U, 100U, 103U, 210U, 99U, 229U, 5U, 200U}) {
    seeker.seek(step);
    const Keyframe here = seeker.keyframe();
    EXPECT_EQ(here.state, frames[step].state) << "step " << step;
    EXPECT_EQ(here.haptics, frames[step].haptics) << "step " << step;
  }
  // A keyframe there and back, in the midst of the lag.
  Session other(model, 1, executor);
  ASSERT_TRUE(other.restore(frames[120]));
  EXPECT_EQ(other.keyframe().state, frames[120].state);
  EXPECT_EQ(other.keyframe().haptics, frames[120].haptics);
  test::rerun(other, recording.step(121));
  EXPECT_EQ(other.keyframe().haptics, frames[121].haptics);
}

TEST(Live, AStallStretchesTheClockAndSaysSo) {
  const test::SmallScene scene = test::smallScene();
  const test::Folder folder;
  for (const bool live : {true, false}) {
    RunSettings run;
    run.live = live;
    run.paced = !live;
    run.seconds = 0.5;
    const std::unique_ptr<SampleSource> source = test::performer(scene, "skilled", 4);
    const Recorded recorded =
        record(scene, *source, folder / (live ? "live.h5" : "paced.h5"), run, [](std::uint64_t step) {
          if (step == 20) std::this_thread::sleep_for(milliseconds(400));
        });
    expectExact(recorded.file);
    Recording recording(recorded.file);
    const Looked seen = lookInto(recording);
    EXPECT_GE(seen.events, 1U);
    EXPECT_GT(seen.stretched, 0.1);
    EXPECT_NEAR(seen.stretched, recorded.report.stretched, 1e-4);
    EXPECT_GE(recorded.report.maxLateness, 0.2);
    EXPECT_EQ(seen.missed, recorded.report.missedDeadlines);
  }
}

/// A performer that does something else, too.
class Wrapped : public SampleSource {
 public:
  explicit Wrapped(std::unique_ptr<SampleSource> inner) : inner_(std::move(inner)) {}
  [[nodiscard]] const Provenance& provenance() const override { return inner_->provenance(); }
  bool next(std::uint64_t tick, TickSamples& out) override { return inner_->next(tick, out); }

 private:
  std::unique_ptr<SampleSource> inner_;
};

class Pausing final : public Wrapped {
 public:
  using Wrapped::Wrapped;
  bool next(std::uint64_t tick, TickSamples& out) override {
    ticks = tick + 1;
    return Wrapped::next(tick, out);
  }
  SourceStatus status() override {
    ++asked;
    if (ticks == 100 && pauseLeft > 0) {
      --pauseLeft;
      return SourceStatus::paused;
    }
    return ticks == 200 ? SourceStatus::failed : SourceStatus::ok;
  }
  std::uint64_t ticks = 0;
  int asked = 0, pauseLeft = 10;
};

TEST(Live, APausingSourceHoldsTheTicksAndAFailingOneEndsTheAttempt) {
  const test::SmallScene scene = test::smallScene();
  const test::Folder folder;
  for (const bool live : {true, false}) {
    Pausing source(test::performer(scene, "skilled", 4));
    RunSettings run;
    run.live = live;
    run.paced = !live;
    const Recorded recorded = record(scene, source, folder / (live ? "l.h5" : "p.h5"), run, [](std::uint64_t) {});
    EXPECT_EQ(recorded.report.outcome, Outcome::technicalFailure);
    EXPECT_EQ(recorded.report.steps, 20U);
    EXPECT_EQ(recorded.report.ticks, 200U);
    EXPECT_EQ(recorded.report.pauses.count, 1U);
    EXPECT_GE(recorded.report.pauses.seconds, 0.015);
    EXPECT_EQ(source.pauseLeft, 0);
    EXPECT_EQ(Recording(recorded.file).outcome(), Outcome::technicalFailure);
    expectExact(recorded.file);
  }
}

TEST(Live, StoppingEndsAPauseToo) {
  class Gone final : public Wrapped {
   public:
    using Wrapped::Wrapped;
    SourceStatus status() override {
      if (++asked == 5) stop = true;
      return SourceStatus::paused;
    }
    int asked = 0;
    std::atomic<bool> stop{false};
  };
  const test::SmallScene scene = test::smallScene();
  for (const bool live : {true, false}) {
    Gone source(test::performer(scene, "skilled", 4));
    SerialExecutor executor;
    Session session(*scene.model, 4, executor);
    RunSettings run;
    run.live = live;
    run.stop = &source.stop;
    const RunReport report = runAttempt(session, source, run);
    EXPECT_EQ(report.outcome, Outcome::stopped);
    EXPECT_EQ(report.steps, 0U);
  }
}

TEST(Live, WhatTheSourceThrowsArrivesAndSoDoesWhatAnObserverThrows) {
  class Throwing final : public Wrapped {
   public:
    using Wrapped::Wrapped;
    bool next(std::uint64_t tick, TickSamples& out) override {
      if (tick == 37) throw std::runtime_error("no more");
      return Wrapped::next(tick, out);
    }
  };
  const test::SmallScene scene = test::smallScene();
  SerialExecutor executor;
  RunSettings run;
  run.live = true;
  {
    Throwing source(test::performer(scene, "skilled", 4));
    Session session(*scene.model, 4, executor);
    EXPECT_THROW(runAttempt(session, source, run), std::runtime_error);
    EXPECT_EQ(session.steps(), 3U) << "whole steps are done all the same";
  }
  class Refusing final : public Observer {
   public:
    void onStep(const StepRecord& record) override {
      if (record.step == 4) throw std::logic_error("enough");
    }
    void onEnd(Outcome /*outcome*/) override {}
  } refusing;
  const std::unique_ptr<SampleSource> source = test::performer(scene, "skilled", 4);
  Session session(*scene.model, 4, executor);
  session.join(refusing);
  EXPECT_THROW(runAttempt(session, *source, run), std::logic_error);
}

TEST(Live, ItRunsToTheSourcesEndAndDropsAnUnfinishedStep) {
  class Short final : public Wrapped {
   public:
    using Wrapped::Wrapped;
    bool next(std::uint64_t tick, TickSamples& out) override { return tick < 123 && Wrapped::next(tick, out); }
  };
  const test::SmallScene scene = test::smallScene();
  const test::Folder folder;
  Short source(test::performer(scene, "skilled", 4));
  RunSettings run;
  run.live = true;
  std::uint64_t told = 0;
  run.feedback = [&told](const TickOutcome&) { ++told; };
  const Recorded recorded = record(scene, source, folder / "short.h5", run, [](std::uint64_t) {});
  EXPECT_EQ(recorded.report.outcome, Outcome::completed);
  EXPECT_EQ(recorded.report.steps, 12U);
  EXPECT_EQ(told, 123U);
  EXPECT_EQ(Recording(recorded.file).tickCount(), 120U);
  expectExact(recorded.file);
}

}  // namespace
}  // namespace calot::recorder
