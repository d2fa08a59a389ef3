// SPDX-License-Identifier: GPL-3.0-or-later
// The session without a window: what it records replays bit for bit, and the rules of the modes hold.
#include "gui/trainer/training_session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "gui/trainer/attempt_report.h"
#include "recorder/base/errors.h"
#include "recorder/recording/reader.h"
#include "recorder/replay.h"
#include "tests/gui/trainer/support/trainer_rig.h"
#include "tests/support/message.h"

namespace calot::gui {
namespace {

using recorder::Outcome;
using trainertest::expectExact;
using trainertest::ScriptInput;
using trainertest::waitFor;
using trainertest::waitForTime;

/// A session over a script of so many seconds.
struct Rig {
  recorder::test::Folder folder;
  std::shared_ptr<ScriptInput> input;
  std::atomic<int> views{0};
  std::atomic<std::size_t> clips{0};  ///< the most that a view has shown
  std::unique_ptr<TrainingSession> session;

  explicit Rig(double seconds, recorder::Mode mode = recorder::Mode::practice)
      : input(std::make_shared<ScriptInput>(trainertest::swayingScript(seconds))) {
    TrainingSettings settings = trainertest::smallSettings(folder);
    settings.attempt.mode = mode;
    session = std::make_unique<TrainingSession>(std::move(settings), input, [this](auto view) {
      EXPECT_GT(view->surface.size(), 0U);
      ++views;
      clips = std::max<std::size_t>(clips, view->clip.size());
      session->shown(view->step);
    });
  }
  /// @returns whether the attempt ended within a minute
  bool ended() {
    return waitFor([this] { return session->status().stage == Stage::ended && !session->status().file.empty(); });
  }
  std::size_t recordings() {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "")) {
      EXPECT_EQ(entry.path().extension(), ".h5") << entry.path();
      ++count;
    }
    return count;
  }
};

TEST(TrainingSession, RecordsAsTheCommandLineDoesAndReplaysExactly) {
  Rig rig(3.0);
  rig.session->start();
  ASSERT_TRUE(waitForTime(*rig.session, 0.2));
  EXPECT_TRUE(rig.session->mount(Hand::right, InstrumentKind::clipApplier));
  ASSERT_TRUE(rig.ended());
  const TrainingStatus status = rig.session->status();
  EXPECT_EQ(status.problem, "");
  EXPECT_EQ(status.report.outcome, Outcome::completed);
  EXPECT_EQ(status.report.disagreements, 0U);
  EXPECT_NEAR(status.figures.time, 2.99, 1e-9) << "the whole steps of the script";
  EXPECT_GT(rig.views, 5);
  EXPECT_LE(rig.views, 120);
  expectExact(status.file);

  recorder::Recording recording(status.file);
  EXPECT_EQ(recording.header().participant, "P7");
  EXPECT_EQ(recording.header().attempt, status.attempt);
  EXPECT_EQ(recording.header().mode, recorder::Mode::practice);
  EXPECT_EQ(recording.header().provenance.device, "scripted");
  EXPECT_EQ(recording.outcome(), Outcome::completed);
  EXPECT_GT(recording.rawSampleCount(Hand::right), 200U);
  EXPECT_EQ(recording.step(0).result.hand[1].instrument, InstrumentKind::grasper);
  const recorder::RecordedStep& last = recording.step(recording.stepCount() - 1);
  EXPECT_EQ(last.result.hand[1].instrument, InstrumentKind::clipApplier);
  EXPECT_EQ(last.result.hand[0].instrument, InstrumentKind::grasper);
  std::uint64_t missed = 0;
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    for (const recorder::TickOutcome& tick : recording.step(n).ticks) missed += tick.lateness > recorder::tickDeadline;
  }
  EXPECT_EQ(status.figures.missedDeadlines, missed);
  // The jaws close on nothing each second, at the step after 0.811 s: that is an error.
  ASSERT_EQ(status.figures.errors->size(), 1U);
  const analytics::ErrorLine& error = status.figures.errors->front();
  EXPECT_EQ(error.text, "clip lost");
  EXPECT_NEAR(error.time - std::floor(error.time), 0.82, 0.011);
  // The first of them is seen as it falls, here and in the replay.
  EXPECT_GT(rig.clips, 0U);
  recorder::Seeker seeker(recording);
  const std::vector<Event> events = recording.events();
  EXPECT_EQ(events.size(), recording.eventCount());
  const auto lost = std::ranges::find(events, EventKind::clipDropped, &Event::kind);
  ASSERT_NE(lost, events.end());
  const std::uint64_t first = lost->step;
  seeker.seek(first - 1);
  EXPECT_TRUE(seeker.view().clip.empty());
  seeker.seek(first);
  const SceneView falling = seeker.view();
  ASSERT_EQ(falling.clip.size(), 1U);
  EXPECT_LT((falling.clip[0].pose.position - recording.step(first).result.hand[1].tipSimulated).norm(), 0.003);
}

TEST(TrainingSession, AnAttemptBeginsWhenItsFirstPictureWasShown) {
  recorder::test::Folder folder;
  const auto input = std::make_shared<ScriptInput>(trainertest::swayingScript(0.3));
  TrainingSettings settings = trainertest::smallSettings(folder);
  settings.firstPicture = std::chrono::minutes(5);
  std::atomic<int> views{0};
  TrainingSession session(std::move(settings), input, [&](const auto& /*view*/) { ++views; });
  session.start();
  ASSERT_TRUE(waitFor([&] { return views > 0; }));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(session.status().stage, Stage::preparing);
  EXPECT_EQ(views, 1);
  session.shown(0);
  EXPECT_TRUE(waitFor([&] { return session.status().stage == Stage::ended; }));
  EXPECT_EQ(session.status().report.outcome, Outcome::completed);
}

TEST(TrainingSession, TimeStartsWithTheFirstMotion) {
  recorder::test::Folder folder;
  const auto input = std::make_shared<ScriptInput>(trainertest::swayingScript(1.0));
  TrainingSettings settings = trainertest::smallSettings(folder);
  settings.fromFirstMotion = true;
  TrainingSession session(std::move(settings), input, [](const auto& /*view*/) {});
  session.start();
  ASSERT_TRUE(waitFor([&] { return session.status().stage == Stage::ready; }));
  EXPECT_FALSE(session.finish());
  ASSERT_TRUE(waitFor([&] { return session.status().stage == Stage::ended; }));
  const TrainingStatus status = session.status();
  EXPECT_EQ(status.report.outcome, Outcome::completed);
  // The script's hands go 2 mm in the first tenth of a second.
  EXPECT_NEAR(status.figures.time, 0.9, 0.03);
  expectExact(status.file);
}

TEST(TrainingSession, WhoQuitsBeforeTheFirstMotionMadeNoAttempt) {
  recorder::test::Folder folder;
  recorder::DeviceScript still = trainertest::swayingScript(1.0);
  for (recorder::DeviceSample& sample : still.samples) {
    sample.position = Vec3::Zero();
    sample.gripper = 0.0;
  }
  for (int i = 0; i < 2000; ++i) {  // for ten seconds more
    recorder::DeviceSample next = still.samples.back();
    next.hostTime = next.deviceTime += 5'000'000;
    still.samples.push_back(next);
  }
  const auto input = std::make_shared<ScriptInput>(still);
  TrainingSettings settings = trainertest::smallSettings(folder);
  settings.fromFirstMotion = true;
  TrainingSession session(std::move(settings), input, [](const auto& /*view*/) {});
  session.start();
  ASSERT_TRUE(waitFor([&] { return session.status().stage == Stage::ready; }));
  session.stop();
  EXPECT_TRUE(session.recorded().empty());
  EXPECT_TRUE(std::filesystem::is_empty(folder / ""));
}

TEST(TrainingSession, APauseLeavesNoTick) {
  Rig rig(0.8);
  rig.session->start();
  ASSERT_TRUE(waitForTime(*rig.session, 0.2));
  EXPECT_FALSE(rig.session->resume());
  ASSERT_TRUE(rig.session->pause());
  EXPECT_FALSE(rig.session->pause());
  EXPECT_FALSE(rig.session->mount(Hand::left, InstrumentKind::hook));
  EXPECT_EQ(rig.session->status().stage, Stage::paused);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));  // the steps that had begun
  const double held = rig.session->status().figures.time;
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(rig.session->status().figures.time, held);
  ASSERT_TRUE(rig.session->resume());
  ASSERT_TRUE(rig.ended());
  const TrainingStatus status = rig.session->status();
  EXPECT_EQ(status.report.pauses.count, 1U);
  EXPECT_GE(status.report.pauses.seconds, 0.4);
  EXPECT_EQ(status.report.steps, 79U) << "the script stood still meanwhile";
  expectExact(status.file);
}

TEST(TrainingSession, GoesBackAndBranches) {
  Rig rig(3.0);
  rig.session->start();
  ASSERT_TRUE(waitForTime(*rig.session, 0.1));
  ASSERT_TRUE(rig.session->mount(Hand::right, InstrumentKind::scissors));
  ASSERT_TRUE(waitForTime(*rig.session, 0.9));
  const TrainingStatus parent = rig.session->status();
  EXPECT_FALSE(rig.session->goBack(0.0)) << "before the first step";
  EXPECT_FALSE(rig.session->goBack(60.0)) << "not yet there";
  ASSERT_TRUE(rig.session->goBack(0.5));
  ASSERT_TRUE(waitFor([&] { return rig.session->status().parent == parent.attempt; }));
  ASSERT_TRUE(waitForTime(*rig.session, 0.7));
  const TrainingStatus branch = rig.session->status();
  EXPECT_NEAR(branch.branchedAt, 0.5, 1e-9);
  ASSERT_TRUE(rig.session->goBack(0.6));  // of the branch
  ASSERT_TRUE(waitFor([&] { return rig.session->status().parent == branch.attempt; }));
  ASSERT_TRUE(waitForTime(*rig.session, 0.8));
  ASSERT_TRUE(rig.session->finish());
  ASSERT_TRUE(rig.ended());
  const TrainingStatus twig = rig.session->status();
  EXPECT_EQ(twig.report.outcome, twig.figures.touched ? Outcome::completed : Outcome::abandoned);
  ASSERT_TRUE(rig.session->goBack(0.7));  // of an attempt that has ended
  ASSERT_TRUE(waitFor([&] { return rig.session->status().parent == twig.attempt; }));
  ASSERT_TRUE(waitForTime(*rig.session, 0.75));
  rig.session->stop();
  const TrainingStatus last = rig.session->status();
  EXPECT_EQ(rig.session->recorded().size(), 8U) << "two lines each";
  EXPECT_EQ(rig.recordings(), 4U);

  for (const auto& file : {parent.file, branch.file, twig.file, last.file}) expectExact(file);
  recorder::Recording a(parent.file), b(branch.file);
  EXPECT_EQ(a.outcome(), Outcome::stopped);
  EXPECT_EQ(b.header().parent, a.header().attempt);
  EXPECT_EQ(b.header().forkStep, 49);
  for (std::uint64_t n = 0; n < 50; ++n) ASSERT_EQ(a.step(n).brief, b.step(n).brief) << n;
  // A lesson is what the branch did otherwise, from the fork to the end of the shorter one.
  const Lesson lesson = lessonOf(parent.file, branch.file);
  EXPECT_NEAR(lesson.seconds, std::min(a.seconds(), b.seconds()) - 0.5, 1e-9);
  ASSERT_EQ(lesson.figures.size(), 7U);
  EXPECT_EQ(lesson.figures[0].text, (std::array<std::string, 2>{"none", "none"}));
  EXPECT_THROW(lessonOf(parent.file, twig.file), Error) << "a branch of the branch";
  // The hands set out from where they were, with what they had.
  const TickSamples before = b.step(49).samples.back();
  const TickSamples after = b.step(50).samples.front();
  for (std::size_t h = 0; h < handCount; ++h)
    EXPECT_LT((after.hand[h].position - before.hand[h].position).norm(), 1e-4) << h;
  EXPECT_EQ(before.hand[1].instrument, InstrumentKind::scissors);
  EXPECT_EQ(after.hand[1].instrument, InstrumentKind::scissors);
}

TEST(TrainingSession, GoesOnWithAnothersRecording) {
  Rig rig(2.0);
  rig.session->start();
  ASSERT_TRUE(waitForTime(*rig.session, 0.8));
  rig.session->stop();
  const std::filesystem::path trainees = rig.session->status().file;
  const std::string parent = recorder::Recording(trainees).header().attempt;
  recorder::test::Folder folder;
  TrainingSettings settings = trainertest::smallSettings(folder);
  settings.attempt.participant = "I1";
  TrainingSession session(std::move(settings), rig.input, [](const auto& /*view*/) {});
  EXPECT_TRUE(session.branchOf(trainees, 0.4));
  ASSERT_TRUE(waitFor([&] { return session.status().parent == parent && session.status().stage == Stage::running; }));
  ASSERT_TRUE(waitForTime(session, 0.6));
  session.stop();
  const TrainingStatus status = session.status();
  EXPECT_EQ(status.parentFile, trainees);
  expectExact(status.file);
  recorder::Recording branch(status.file);
  EXPECT_EQ(branch.header().participant, "I1") << "who goes on is who acts";
  EXPECT_EQ(branch.header().forkStep, 39);
  TrainingSession wrong(trainertest::smallSettings(folder), rig.input, [](const auto& /*view*/) {});
  EXPECT_TRUE(wrong.branchOf(folder / "gone.h5", 0.4));
  ASSERT_TRUE(waitFor([&] { return wrong.status().stage == Stage::ended; }));
  expectHolds(wrong.status().problem, {"gone.h5"});
}

TEST(TrainingSession, WhatIsNotKeptGoesWithTheSession) {
  std::filesystem::path file;
  {
    TrainingSettings settings = trainertest::smallSettings(recorder::test::Folder());
    settings.folder.clear();
    TrainingSession session(std::move(settings), std::make_shared<ScriptInput>(trainertest::swayingScript(0.5)),
                            [](const auto& /*view*/) {});
    session.start();
    ASSERT_TRUE(waitFor([&] { return session.status().stage == Stage::ended; }));
    file = session.status().file;
    EXPECT_FALSE(session.status().kept);
    expectExact(file);
    EXPECT_TRUE(session.recorded().empty());
  }
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_FALSE(std::filesystem::exists(file.parent_path()));
}

TEST(TrainingSession, AnExchangeOfInstrumentsTakesItsTimeAndReplays) {
  Rig rig(30.0);
  rig.session->start();
  ASSERT_TRUE(waitForTime(*rig.session, 0.2));
  ASSERT_TRUE(rig.session->mount(Hand::left, InstrumentKind::hook));
  ASSERT_TRUE(waitFor([&] { return rig.session->status().exchange[0].has_value(); }));
  EXPECT_EQ(rig.session->status().exchange[0]->coming, InstrumentKind::hook);
  EXPECT_FALSE(rig.session->status().exchange[1]);
  ASSERT_TRUE(waitFor([&] { return rig.session->status().figures.hand[0].instrument == InstrumentKind::hook; }));
  rig.session->stop();
  const TrainingStatus status = rig.session->status();
  expectExact(status.file);
  recorder::Recording recording(status.file);
  std::uint64_t empty = 0;
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    for (const TickSamples& tick : recording.step(n).samples) {
      empty += tick.hand[0].instrument == InstrumentKind::none;
      EXPECT_EQ(tick.hand[1].instrument, InstrumentKind::grasper);
    }
  }
  EXPECT_EQ(empty, 200U) << "ticks";
}

TEST(TrainingSession, GoingBackIntoAnExchangeGoesOnWithTheOldInstrument) {
  Rig rig(30.0);
  rig.session->start();
  ASSERT_TRUE(waitForTime(*rig.session, 0.3));
  ASSERT_TRUE(rig.session->mount(Hand::right, InstrumentKind::hook));
  ASSERT_TRUE(waitFor([&] { return rig.session->status().exchange[1].has_value(); }));
  const double within = rig.session->status().figures.time + 0.1;
  ASSERT_TRUE(waitForTime(*rig.session, within + 0.3));
  const TrainingStatus parent = rig.session->status();
  ASSERT_TRUE(rig.session->goBack(within));
  ASSERT_TRUE(waitFor([&] { return rig.session->status().parent == parent.attempt; }));
  ASSERT_TRUE(waitForTime(*rig.session, within + 0.1));
  rig.session->stop();
  const TrainingStatus branch = rig.session->status();
  expectExact(branch.file);
  recorder::Recording recording(branch.file);
  const auto fork = static_cast<std::uint64_t>(recording.header().forkStep);
  const InstrumentSample before = recording.step(fork).samples.back().hand[1];
  const InstrumentSample after = recording.step(fork + 1).samples.front().hand[1];
  EXPECT_EQ(before.instrument, InstrumentKind::none);
  EXPECT_EQ(after.instrument, InstrumentKind::grasper);
  EXPECT_LT((after.position - before.position).norm(), 1e-4);
}

TEST(TrainingSession, AfterGoingBackTheHandsWaitForTheCountdown) {
  recorder::test::Folder folder;
  const auto input = std::make_shared<ScriptInput>(trainertest::swayingScript(30.0));
  TrainingSettings settings = trainertest::smallSettings(folder);
  settings.countdown = std::chrono::minutes(5);
  TrainingSession session(std::move(settings), input, [](const auto& /*view*/) {});
  session.start();
  ASSERT_TRUE(waitForTime(session, 0.5)) << "a new attempt has no countdown";
  ASSERT_TRUE(session.goBack(0.3));
  ASSERT_TRUE(waitFor([&] { return session.status().stage == Stage::countdown; }));
  EXPECT_GE(session.status().countdown, 299);
  EXPECT_FALSE(session.finish());
  EXPECT_FALSE(session.mount(Hand::left, InstrumentKind::hook));
  session.start();  // another command ends it
  EXPECT_TRUE(waitFor([&] { return session.status().stage == Stage::running && session.status().parent.empty(); }));
}

TEST(TrainingSession, HoldingStillIsNotCompleted) {
  Rig rig(30.0);
  rig.session->start();
  ASSERT_TRUE(waitForTime(*rig.session, 0.1));
  ASSERT_FALSE(rig.session->status().figures.touched);
  ASSERT_TRUE(rig.session->finish());
  ASSERT_TRUE(rig.ended());
  expectNames(rig.session->status().undone, {"touched"});
  EXPECT_EQ(recorder::Recording(rig.session->status().file).outcome(), Outcome::abandoned);
}

TEST(TrainingSession, AnAssessmentIsNeitherPausedNorBranched) {
  Rig rig(5.0, recorder::Mode::assessment);
  rig.session->start();
  ASSERT_TRUE(waitForTime(*rig.session, 0.3));
  EXPECT_FALSE(rig.session->pause());
  EXPECT_FALSE(rig.session->goBack(0.2));
  EXPECT_TRUE(rig.session->mount(Hand::left, InstrumentKind::hook)) << "instruments are exchanged in life, too";
  ASSERT_TRUE(rig.session->finish());
  ASSERT_TRUE(rig.ended());
  EXPECT_FALSE(rig.session->goBack(0.2));
  recorder::Recording recording(rig.session->status().file);
  EXPECT_EQ(recording.header().mode, recorder::Mode::assessment);
}

TEST(TrainingSession, StartingAgainAbandonsAndQuittingStops) {
  Rig rig(30.0);
  rig.session->start();
  ASSERT_TRUE(waitForTime(*rig.session, 0.2));
  const std::filesystem::path first = rig.session->status().file;
  ASSERT_TRUE(rig.session->pause());
  rig.session->start();  // out of a pause
  ASSERT_TRUE(waitFor([&] { return rig.session->status().file != first; }));
  ASSERT_TRUE(waitForTime(*rig.session, 0.1));
  const std::filesystem::path second = rig.session->status().file;
  rig.session->stop();
  rig.session->start();  // nothing any more
  rig.session.reset();
  EXPECT_EQ(recorder::Recording(first).outcome(), Outcome::abandoned);
  EXPECT_EQ(recorder::Recording(second).outcome(), Outcome::stopped);
  EXPECT_EQ(rig.recordings(), 2U);
  for (const auto& file : {first, second}) expectExact(file);
}

TEST(TrainingSession, SaysWhatIsWrongAndTriesAgain) {
  Rig rig(0.3);
  rig.input->refusal = "gamepad: none is attached";
  rig.session->start();
  ASSERT_TRUE(waitFor([&] { return rig.session->status().stage == Stage::ended; }));
  EXPECT_EQ(rig.session->status().problem, "gamepad: none is attached");
  EXPECT_EQ(rig.recordings(), 0U);
  EXPECT_FALSE(rig.session->goBack(0.1));
  EXPECT_FALSE(rig.session->finish());
  rig.input->refusal.clear();
  rig.session->start();
  ASSERT_TRUE(rig.ended());
  EXPECT_EQ(rig.session->status().problem, "");
  EXPECT_EQ(rig.recordings(), 1U);
}

}  // namespace
}  // namespace calot::gui
