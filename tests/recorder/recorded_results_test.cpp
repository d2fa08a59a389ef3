// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings of earlier versions, judged by today's rules from what they hold.
#include "recorder/recorded_results.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "recorder/formats/scene_file.h"
#include "recorder/replay.h"
#include "sim/scene/version.h"
#include "tests/recorder/support/performed_recording.h"
#include "tests/recorder/support/small_scene.h"

namespace calot::recorder {
namespace {

const std::filesystem::path root = CALOT_SOURCE_DIR;

/// Seven seconds of clip-and-cut by simulation version 12: one clip is set, half on.
const std::filesystem::path ofVersion3 = root / "tests/recorder/recording/data/step-result-3.h5";

std::size_t countOf(const std::vector<Event>& events, EventKind kind) {
  return static_cast<std::size_t>(
      std::count_if(events.begin(), events.end(), [&](const Event& e) { return e.kind == kind; }));
}

TEST(VersionThree, IsReadWithTheJudgementOfItsTime) {
  Recording recording(ofVersion3);
  EXPECT_EQ(recording.header().stepResultVersion, 3U);
  EXPECT_EQ(recording.header().simulationVersion, 12U);
  EXPECT_TRUE(recording.verifyChain().intact());
  const RecordedProcedure first = recording.step(0).procedure;
  EXPECT_EQ(first.phase, Phase::clipping);
  EXPECT_FALSE(first.criticalViewFrozen);
  const RecordedProcedure last = recording.step(recording.stepCount() - 1).procedure;
  EXPECT_TRUE(last.criticalViewFrozen);
  EXPECT_EQ(last.errors, 1U);
}

TEST(VersionThree, IsNotDecidedByThisBuild) {
  const ReplayReport report = replayRecording(ofVersion3, {});
  EXPECT_EQ(report.verdict, ReplayVerdict::undecided) << report.error;
}

/// The same rules come to the same judgement at every step, though it was the simulation that judged then. Errors are
/// judged by today's rules.
TEST(VersionThree, IsJudgedTodayAsItWasThen) {
  Recording recording(ofVersion3);
  RecordedJudge judge(recording.header());
  std::size_t halfOn = 0;
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    const RecordedStep& step = recording.step(n);
    const Judgement& now = judge.observe(step);
    ASSERT_EQ(now.phase, step.procedure.phase) << n;
    ASSERT_EQ(now.triangleCleared, step.procedure.triangleCleared) << n;
    ASSERT_EQ(now.lowerThirdFreed, step.procedure.lowerThirdFreed) << n;
    ASSERT_EQ(now.twoStructures, step.procedure.twoStructures) << n;
    ASSERT_EQ(now.criticalViewFrozen, step.procedure.criticalViewFrozen) << n;
    ASSERT_EQ(now.lowerThirdAttached, step.procedure.lowerThirdAttached) << n;
    halfOn += countOf(now.events, EventKind::clipHalfOn);
  }
  EXPECT_EQ(halfOn, 1U) << "once, not once as recorded and once more";
}

/// Steps as version 3 recorded them of an operation with fat and bed.
class EarlierOperation : public testing::Test {
 protected:
  EarlierOperation() {
    scene_.organs.emplace_back().name = "gallbladder";
    for (const char* name : {"duct", "artery"}) scene_.vessels.emplace_back().name = name;
    scene_.connective.emplace_back().name = "bed";
    scene_.fat.emplace_back().name = "fat";
    scene_.procedure = {"gallbladder", "bed", "fat", {{"duct", 2, 1, true}, {"artery", 2, 1, true}}, {}};
    header_.stepResultVersion = 3;
    step_.result.organ.resize(1);
    step_.result.connective.resize(1);
    step_.result.connective[0].attached = 1.0;
    step_.result.vessel.resize(2);
    step_.result.fat.resize(1);
    step_.result.fat[0].toClear = 4e-6;
    step_.procedure.lowerThirdAttached = 1.0;
  }
  SceneDescription scene_;
  AttemptHeader header_;
  RecordedStep step_;
};

TEST_F(EarlierOperation, FactsComeFromWhatIsThere) {
  RecordedResults results(header_, scene_);
  EXPECT_EQ(results.of(step_).fat[0].uncleared, 1.0);
  step_.result.fat[0].toClear = 1e-6;
  step_.procedure.lowerThirdAttached = 0.4;
  step_.procedure.twoStructures = 1;
  const StepResult& now = results.of(step_);
  EXPECT_EQ(now.fat[0].uncleared, 0.25);
  EXPECT_EQ(now.connective[0].lowerAttached, 0.4);
  EXPECT_EQ(now.vessel[0].covered, 0.0);
  EXPECT_EQ(now.vessel[1].covered, 1.0) << "one of two was bare";
  step_.result.vessel[0].partings = 1;
  EXPECT_EQ(results.of(step_).vessel[1].covered, 0.0) << "the one that is whole";
}

TEST_F(EarlierOperation, OtherThresholdsJudgeItAnew) {
  JudgementRules loose;
  loose.clearedTwo = 0.3;
  loose.freedTwo = 0.5;
  RecordedResults results(header_, scene_);
  Judge usual(scene_);
  Judge looser(scene_, loose);
  usual.observe(results.of(step_));
  looser.observe(results.of(step_));
  step_.result.fat[0].toClear = 1e-6;
  step_.procedure.lowerThirdAttached = 0.4;
  step_.procedure.twoStructures = 2;
  const StepResult& now = results.of(step_);
  EXPECT_EQ(usual.observe(now).criticalView(), 1 + 1 + 2);
  EXPECT_EQ(looser.observe(now).criticalView(), 2 + 2 + 2);
}

TEST_F(EarlierOperation, LaterVersionsPassUnchanged) {
  header_.stepResultVersion = stepResultVersion;
  step_.result.fat[0].uncleared = 0.7;
  RecordedResults results(header_, scene_);
  EXPECT_EQ(&results.of(step_), &step_.result);
}

/// Before version 7 nothing tells what fat holds: they are done when they were.
TEST_F(EarlierOperation, AreDoneWithoutAskingTheFat) {
  for (const std::uint32_t version : {3U, 4U, 6U, stepResultVersion}) {
    SCOPED_TRACE(version);
    header_.stepResultVersion = version;
    RecordedResults results(header_, scene_);
    Judge judge(scene_);
    RecordedStep last = step_;
    last.result.vessel[0].partings = last.result.vessel[1].partings = 1;
    last.result.connective[0].attached = 0.0;
    EXPECT_EQ(judge.observe(results.of(last)).phase, Phase::done);
  }
}

/// A recorded operation, judged by the rules and by others: the replay is bit-exact both times.
TEST(GoldenContent, ARuleIsChangedAndNoBitIs) {
  struct Judging final : Observer {
    Judge judge;
    explicit Judging(const SceneDescription& scene, const JudgementRules& rules) : judge(scene, rules) {}
    void onStep(const StepRecord& record) override {
      judge.observe(record.result);
      for (const Event& event : record.result.events) clips += event.kind == EventKind::clipSet ? 1 : 0;
    }
    std::uint32_t clips = 0;
    void onEnd(Outcome) override {}
  };
  JudgementRules strict;
  strict.encloses = 1.5;  // no clip can
  strict.freedOne = strict.freedTwo = -1.0;
  std::unique_ptr<Judging> usual;
  std::unique_ptr<Judging> stricter;
  ReplaySettings settings;
  settings.observers = [&](const AttemptHeader&, const SceneDescription& scene) {
    usual = std::make_unique<Judging>(scene, JudgementRules());
    stricter = std::make_unique<Judging>(scene, strict);
    return std::vector<Observer*>{usual.get(), stricter.get()};
  };
  const test::Folder folder;
  test::recordSkilled(folder / "clips.h5", "clip-and-cut", 2, 0.0);
  const ReplayReport report = replayRecording(folder / "clips.h5", settings);
  ASSERT_EQ(report.verdict, ReplayVerdict::exact) << report.error;
  const Judgement& a = usual->judge.judgement();
  const Judgement& b = stricter->judge.judgement();
  EXPECT_EQ(a.phase, Phase::done);
  EXPECT_EQ(b.phase, Phase::done);
  EXPECT_EQ(stricter->clips, 6U);
  EXPECT_EQ(b.errors(Severity::major), a.errors(Severity::major) + stricter->clips) << "all clips";
  EXPECT_EQ(a.criticalView(), 6);
  EXPECT_EQ(b.criticalView(), 4);
}

}  // namespace
}  // namespace calot::recorder
