// SPDX-License-Identifier: GPL-3.0-or-later
// The judge over results made by hand: every rule at its threshold, and other thresholds.
#include "sim/judgement/judge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/scene/version.h"

namespace calot {
namespace {

constexpr std::uint16_t toDivide = 2, alsoToDivide = 3, toSpare = 4;

/// An operation with everything: two organs, a bed, three vessels, fat.
SceneDescription sceneOfAll() {
  SceneDescription scene;
  for (const char* name : {"liver", "gallbladder"}) scene.organs.emplace_back().name = name;
  for (const char* name : {"duct", "artery", "spared"}) scene.vessels.emplace_back().name = name;
  scene.vessels[0].role = StructureRole::cysticDuct;
  scene.vessels[1].role = StructureRole::cysticArtery;
  scene.connective.emplace_back().name = "bed";
  scene.fat.emplace_back().name = "fat";
  scene.procedure = {"gallbladder", "bed", "fat", {{"duct", 2, 1, true}, {"artery", 2, 1, false}}, {"spared"}};
  scene.clip.minGap = 0.001;
  scene.clip.minJunctionGap = 0.002;
  return scene;
}

class JudgeTest : public testing::Test {
 protected:
  JudgeTest() {
    now_.organ.resize(2);
    now_.connective.resize(1);
    now_.vessel.resize(3);
    now_.fat.resize(1);
    now_.connective[0].attached = now_.connective[0].lowerAttached = 1.0;
    now_.fat[0].uncleared = 1.0;
    now_.vessel[0].covered = now_.vessel[1].covered = 1.0;
  }
  void tell(EventKind kind, std::uint16_t subject, double value = 0.0) {
    now_.events.push_back({now_.step, kind, 1, subject, Vec3::Zero(), value});
  }
  /// A clip as the step reports one.
  void tellClip(std::uint16_t vessel, double enclosed, double gap, double junction, double end) {
    tell(EventKind::clipSet, vessel, enclosed);
    tell(EventKind::clipPlace, vessel, 0.01);
    if (std::isfinite(gap)) tell(EventKind::clipGap, vessel, gap);
    if (std::isfinite(junction)) tell(EventKind::clipJunctionGap, vessel, junction);
    tell(EventKind::clipEndGap, vessel, end);
  }
  const Judgement& observe(Judge& judge) {
    const Judgement& j = judge.observe(now_);
    ++now_.step;
    now_.events.clear();
    now_.fat[0].carved = 0.0;
    return j;
  }
  static int countOf(const Judgement& j, EventKind kind) {
    return static_cast<int>(
        std::count_if(j.events.begin(), j.events.end(), [&](const Event& e) { return e.kind == kind; }));
  }

  /// All that the critical view asks for.
  void seen() {
    now_.fat[0].uncleared = now_.connective[0].lowerAttached = 0.0;
    now_.vessel[0].covered = now_.vessel[1].covered = 0.0;
  }
  /// A cut as the step reports one. @param open cutOpen's value; 0: closed
  void tellCut(std::uint16_t vessel, double arc, double open, double start, double end) {
    tell(EventKind::vesselCut, vessel, arc);
    if (open > 0.0) tell(EventKind::cutOpen, vessel, open);
    tell(EventKind::clipsTowardsStart, vessel, start);
    tell(EventKind::clipsTowardsEnd, vessel, end);
  }
  static bool has(const Judgement& j, ErrorRule rule) {
    return std::any_of(j.errorList.begin(), j.errorList.end(), [&](const AttemptError& e) {
      return std::find(e.rules.begin(), e.rules.end(), rule) != e.rules.end();
    });
  }

  static constexpr double none = std::numeric_limits<double>::infinity();
  StepResult now_;
};

TEST_F(JudgeTest, PointsOfTheViewChangeAtTheirThresholds) {
  const struct {
    double uncleared, attached, covered;
    int triangle, third, structures;
  } cases[] = {{1.0, 1.0, 1.0, 0, 0, 0},
               {0.36, 0.51, 0.21, 0, 0, 0},
               {0.35, 0.5, 0.2, 1, 1, 2},
               {0.11, 0.06, 0.2, 1, 1, 2},
               {0.10, 0.05, 0.0, 2, 2, 2}};
  for (const auto& c : cases) {
    Judge judge(sceneOfAll());
    now_.fat[0].uncleared = c.uncleared;
    now_.connective[0].lowerAttached = c.attached;
    now_.vessel[0].covered = now_.vessel[1].covered = c.covered;
    const Judgement& j = observe(judge);
    EXPECT_EQ(j.triangleCleared, c.triangle) << c.uncleared;
    EXPECT_EQ(j.lowerThirdFreed, c.third) << c.attached;
    EXPECT_EQ(j.twoStructures, c.structures) << c.covered;
    EXPECT_EQ(j.criticalView(), c.triangle + c.third + c.structures);
  }
}

TEST_F(JudgeTest, OneOfTwoBareVesselsIsOnePoint) {
  Judge judge(sceneOfAll());
  now_.vessel[1].covered = 0.0;
  EXPECT_EQ(observe(judge).twoStructures, 1);
  now_.vessel[1].partings = 1;
  EXPECT_EQ(observe(judge).twoStructures, 0) << "what is cut does not enter any more";
}

TEST_F(JudgeTest, OtherThresholdsAreOtherPoints) {
  JudgementRules strict;
  strict.clearedOne = 0.2;
  strict.bareShare = 0.01;
  Judge usual(sceneOfAll());
  Judge stricter(sceneOfAll(), strict);
  now_.fat[0].uncleared = 0.3;
  now_.vessel[0].covered = now_.vessel[1].covered = 0.1;
  EXPECT_EQ(usual.observe(now_).criticalView(), 3);
  EXPECT_EQ(stricter.observe(now_).criticalView(), 0);
}

TEST_F(JudgeTest, TheFirstClipFreezesTheView) {
  Judge judge(sceneOfAll());
  now_.fat[0].uncleared = 0.2;
  observe(judge);
  tellClip(toDivide, 1.0, none, none, 0.01);
  EXPECT_TRUE(observe(judge).criticalViewFrozen);
  now_.fat[0].uncleared = 0.0;
  EXPECT_EQ(observe(judge).triangleCleared, 1);
}

TEST_F(JudgeTest, PhasesFollowTheLastAct) {
  Judge judge(sceneOfAll());
  EXPECT_EQ(judge.judgement().phase, Phase::identification);
  tell(EventKind::strandsBurned, 0, 0.01);
  EXPECT_EQ(observe(judge).phase, Phase::identification) << "before the first clip: to see";
  tellClip(toDivide, 1.0, none, none, 0.01);
  const Judgement& clipping = observe(judge);
  EXPECT_EQ(clipping.phase, Phase::clipping);
  EXPECT_EQ(clipping.events.back().kind, EventKind::phaseBegin);
  EXPECT_EQ(clipping.events.back().value, static_cast<double>(Phase::identification));
  now_.fat[0].carved = 1e-9;
  EXPECT_EQ(observe(judge).phase, Phase::identification) << "phases recur";
  now_.vessel[0].partings = now_.vessel[1].partings = 1;
  tell(EventKind::vesselCut, toDivide, 0.01);
  EXPECT_EQ(observe(judge).phase, Phase::cutting);
  now_.fat[0].carved = 1e-9;
  EXPECT_EQ(observe(judge).phase, Phase::dissection);
  now_.connective[0].attached = 0.0;
  EXPECT_EQ(observe(judge).phase, Phase::done);
}

TEST_F(JudgeTest, FatThatHoldsTheSpecimenKeepsItFromBeingDone) {
  Judge judge(sceneOfAll());
  now_.vessel[0].partings = now_.vessel[1].partings = 1;
  now_.fat[0].holdsSpecimen = true;
  tell(EventKind::strandsBurned, 0, 0.01);
  now_.connective[0].attached = 0.0;
  EXPECT_EQ(observe(judge).phase, Phase::identification);
  tell(EventKind::fatTorn, 5, 1e-9);
  now_.fat[0].holdsSpecimen = false;
  const Judgement& done = observe(judge);
  EXPECT_EQ(done.phase, Phase::done) << "the last string is gone";
  EXPECT_EQ(done.errors(), 0U) << "a string that tears is no error";
}

TEST_F(JudgeTest, ClipsAreJudgedByTheScenesGaps) {
  const struct {
    double enclosed, gap, junction, end;
    int halfOn, onClip, tooNear;
    double value;
  } cases[] = {{1.0, none, none, 0.01, 0, 0, 0, 0.0},        {0.99, none, none, 0.01, 1, 0, 0, 0.0},
               {1.0, -0.0004, none, 0.01, 0, 1, 0, 0.0},     {1.0, 0.0009, none, 0.01, 0, 0, 1, 0.0009},
               {1.0, 0.001, 0.002, 0.01, 0, 0, 0, 0.0},      {1.0, 0.005, 0.0019, 0.01, 0, 0, 1, 0.0019},
               {1.0, 0.0005, 0.0002, 0.01, 0, 0, 1, 0.0002}, {1.0, none, none, -1e-6, 0, 0, 1, 0.0}};
  for (const auto& c : cases) {
    Judge judge(sceneOfAll());
    tellClip(toDivide, c.enclosed, c.gap, c.junction, c.end);
    const Judgement& j = observe(judge);
    EXPECT_EQ(countOf(j, EventKind::clipHalfOn), c.halfOn);
    EXPECT_EQ(countOf(j, EventKind::clipOnClip), c.onClip);
    EXPECT_EQ(countOf(j, EventKind::clipTooNear), c.tooNear);
    EXPECT_EQ(j.found.size(), static_cast<std::size_t>(c.halfOn + c.onClip + c.tooNear));
    EXPECT_EQ(j.errors(), j.found.empty() ? 0U : 1U) << "one clip, one line";
    for (const Event& e : j.events) {
      if (e.kind == EventKind::clipTooNear) {
        EXPECT_EQ(e.value, c.value);
      }
    }
  }
}

TEST_F(JudgeTest, ClipsThatAreMissingBesideACut) {
  const auto cut = [&](std::uint16_t vessel, double start, double end, bool stays) {
    Judge judge(sceneOfAll());
    seen();
    tell(EventKind::vesselCut, vessel, 0.01);
    tell(EventKind::clipsTowardsStart, vessel, start);
    tell(EventKind::clipsTowardsEnd, vessel, end);
    const Judgement& j = observe(judge);
    double missing = 0.0;
    for (const Event& e : j.events) missing += e.kind == EventKind::tooFewClips ? e.value : 0.0;
    EXPECT_EQ(j.errors(Severity::critical), stays ? 1U : 0U);
    return missing;
  };
  EXPECT_EQ(cut(toDivide, 2.0, 1.0, false), 0.0);
  EXPECT_EQ(cut(toDivide, 1.0, 2.0, true), 1.0) << "a clip more on the one side is none on the other";
  EXPECT_EQ(cut(toDivide, 0.0, 0.0, true), 3.0);
  EXPECT_EQ(cut(alsoToDivide, 1.0, 2.0, false), 0.0) << "it stays at its end";
  EXPECT_EQ(cut(toSpare, 0.0, 0.0, true), 0.0) << "nobody wants clips there";
}

TEST_F(JudgeTest, HarmToWhatIsToBeSparedIsCritical) {
  Judge judge(sceneOfAll());
  tellClip(toSpare, 1.0, none, none, 0.01);
  tell(EventKind::vesselBurned, toSpare, 0.01);
  const Judgement& j = observe(judge);
  EXPECT_EQ(countOf(j, EventKind::criticalError), 2);
  ASSERT_EQ(j.errorList.size(), 1U) << "at once, of one structure";
  EXPECT_EQ(j.errorList[0].rules, (std::vector{ErrorRule::sparedBurned, ErrorRule::sparedClipped}));
  EXPECT_EQ(j.errors(Severity::critical), 1U);
  EXPECT_EQ(j.errors(), 1U) << "burning what is to be divided would be another";
}

/// Version 3 told of clips as they were judged: the facts are not there, so the events count as they are.
TEST_F(JudgeTest, EventsOfOldCountAsTheyWereRecorded) {
  Judge judge(sceneOfAll());
  tell(EventKind::clipSet, toDivide, 0.6);
  tell(EventKind::clipHalfOn, toDivide, 0.6);
  tell(EventKind::vesselCut, toDivide, 0.01);
  tell(EventKind::tooFewClips, toDivide, 2.0);
  tell(EventKind::phaseBegin, 3, 1.0);
  tell(EventKind::criticalError, toSpare, 21.0);
  const Judgement& j = observe(judge);
  EXPECT_EQ(countOf(j, EventKind::clipHalfOn), 1);
  EXPECT_EQ(j.found.size(), 3U) << "half on, too few clips, and not identified";
  EXPECT_EQ(j.errors(Severity::critical), 1U) << "judged anew: nothing happened to what must be spared";
  EXPECT_EQ(countOf(j, EventKind::criticalError), 2) << "its own alone";
  EXPECT_EQ(countOf(j, EventKind::phaseBegin), 1) << "its own alone";
}

TEST_F(JudgeTest, WithoutAProcedureThereAreErrorsAndNoPhases) {
  SceneDescription scene = sceneOfAll();
  scene.procedure = {};
  Judge judge(scene);
  tellClip(toDivide, 0.5, none, none, 0.01);
  const Judgement& j = observe(judge);
  EXPECT_EQ(countOf(j, EventKind::clipHalfOn), 1);
  EXPECT_EQ(j.phase, Phase::none);
  EXPECT_EQ(j.errors(Severity::major), 1U);
  EXPECT_FALSE(j.criticalViewFrozen);
}

TEST_F(JudgeTest, AnEndIsOpenUntilAClipClosesIt) {
  Judge judge(sceneOfAll());
  seen();
  tellCut(toDivide, 0.010, 3.0, 0.0, 0.0);
  const Judgement& j = observe(judge);
  EXPECT_TRUE(has(j, ErrorRule::leftOpen));
  EXPECT_TRUE(has(j, ErrorRule::openTowardsSpecimen)) << "it is a duct";
  ASSERT_EQ(j.errorList.size(), 1U) << "of one cause";
  EXPECT_EQ(j.errorList[0].rules.front(), ErrorRule::leftOpen) << "the gravest first";
  tell(EventKind::clipSet, toDivide, 1.0);
  tell(EventKind::clipPlace, toDivide, 0.012);  // on the specimen's side
  observe(judge);
  EXPECT_TRUE(has(j, ErrorRule::leftOpen));
  EXPECT_FALSE(has(j, ErrorRule::openTowardsSpecimen));
  tell(EventKind::clipSet, toDivide, 0.9);  // half on closes nothing
  tell(EventKind::clipPlace, toDivide, 0.008);
  EXPECT_TRUE(has(observe(judge), ErrorRule::leftOpen));
  tell(EventKind::clipSet, toDivide, 1.0);
  tell(EventKind::clipPlace, toDivide, 0.007);
  observe(judge);
  EXPECT_TRUE(j.changed);
  EXPECT_FALSE(has(j, ErrorRule::leftOpen));
  EXPECT_TRUE(has(j, ErrorRule::tooFewClips)) << "that is done";
}

TEST_F(JudgeTest, ANewCutMakesTheOldEndOnesOfAnotherPiece) {
  Judge judge(sceneOfAll());
  seen();
  tellCut(toDivide, 0.010, 1.0, 0.0, 1.0);
  observe(judge);
  tellCut(toDivide, 0.005, 2.0, 2.0, 0.0);  // nearer to where it stays, behind two clips
  EXPECT_FALSE(has(observe(judge), ErrorRule::leftOpen));
}

TEST_F(JudgeTest, TheSideThatStaysIsTheScenes) {
  Judge judge(sceneOfAll());
  seen();
  tellCut(alsoToDivide, 0.010, 1.0, 0.0, 2.0);  // an artery that stays at its end
  const Judgement& j = observe(judge);
  EXPECT_FALSE(has(j, ErrorRule::leftOpen));
  EXPECT_FALSE(has(j, ErrorRule::openTowardsSpecimen)) << "no bile is in it";
  EXPECT_TRUE(has(j, ErrorRule::tooFewTowardsSpecimen));
  EXPECT_EQ(j.errors(Severity::critical), 0U);
}

TEST_F(JudgeTest, DivisionWithoutTheViewIsCriticalOnceAVessel) {
  Judge judge(sceneOfAll());
  tellClip(toDivide, 1.0, none, none, 0.01);
  observe(judge);
  seen();  // after the first clip: too late
  tellCut(toDivide, 0.010, 0.0, 2.0, 1.0);
  const Judgement& j = observe(judge);
  EXPECT_TRUE(has(j, ErrorRule::notIdentified));
  tellCut(toDivide, 0.012, 0.0, 2.0, 1.0);
  now_.step += 500;
  EXPECT_EQ(observe(judge).errors(Severity::critical), 1U);
  Judge other(sceneOfAll());
  tellCut(toDivide, 0.010, 0.0, 2.0, 1.0);
  EXPECT_FALSE(has(observe(other), ErrorRule::notIdentified)) << "all was seen before the first clip";
  SceneDescription bare = sceneOfAll();
  bare.procedure.fat.clear();
  bare.procedure.bed.clear();
  now_.vessel[0].covered = now_.vessel[1].covered = 1.0;
  Judge hidesNothing(bare);
  tellCut(toDivide, 0.010, 0.0, 2.0, 1.0);
  EXPECT_FALSE(has(observe(hidesNothing), ErrorRule::notIdentified)) << "not assessed";
  EXPECT_EQ(notAssessed(bare, stepResultVersion).size(), 2U);
}

TEST_F(JudgeTest, WhatGoesOnIsOneOccasionAndItsWorstMomentIsKept) {
  Judge judge(sceneOfAll());
  for (const double pull : {1.0, 3.0, 2.0}) {
    tell(EventKind::graspSlip, 1, pull);
    observe(judge);
  }
  now_.step += 101;
  tell(EventKind::graspSlip, 1, 1.5);
  const Judgement& j = observe(judge);
  ASSERT_EQ(j.errorList.size(), 1U);
  EXPECT_EQ(j.errorList[0].count, 2U);
  EXPECT_EQ(j.errorList[0].first, 0U);
  EXPECT_EQ(j.errorList[0].worst, 1U);
  EXPECT_EQ(j.errors(Severity::minor), 2U);
}

TEST_F(JudgeTest, SubjectsThatNoSceneHasAreNoErrors) {
  Judge judge(sceneOfAll());
  for (std::uint16_t subject = 127; subject < 2000; ++subject) tell(EventKind::graspSlip, subject, 1.0);
  EXPECT_EQ(observe(judge).errorList.size(), 1U);
}

TEST_F(JudgeTest, ResultsThatLackWhatTheProcedureNamesAreNotJudged) {
  Judge judge(sceneOfAll());
  now_.vessel.clear();
  now_.fat.clear();
  now_.connective.clear();
  EXPECT_EQ(judge.observe(now_).criticalView(), 0);
}

}  // namespace
}  // namespace calot
