// SPDX-License-Identifier: GPL-3.0-or-later
// Errors, hints, words and keys: what the window says, without a window.
#include "gui/trainer/trainer_texts.h"

#include <gtest/gtest.h>

#include <QLocale>
#include <set>

#include "gui/trainer/operation_view.h"
#include "sim/instruments/instruments.h"
#include "tests/support/message.h"

namespace calot::gui {
namespace {

TEST(Errors, SayWhenHowSevereAndHowOften) {
  EXPECT_EQ(errorText({Severity::critical, 1, 5.0, "hepatic artery clipped, though it must be spared"}),
            "0:05.0  critical: hepatic artery clipped, though it must be spared");
  EXPECT_EQ(errorText({Severity::minor, 18, 65.0, "liver slipped in the jaws"}),
            "1:05.0  minor: liver slipped in the jaws, 18 times");
}

TEST(Errors, ABranchLeavesTwoSecondsBeforeButNotBeforeTheFirstStep) {
  EXPECT_DOUBLE_EQ(branchTime(10.0, 0.01), 8.0);
  EXPECT_DOUBLE_EQ(branchTime(1.5, 0.01), 0.01);
}

SceneDescription operation() {
  SceneDescription scene;
  for (const char* name : {"cystic_duct", "cystic_artery", "common_duct"}) {
    scene.vessels.emplace_back();
    scene.vessels.back().name = name;
  }
  scene.procedure.specimen = "gallbladder";
  scene.procedure.bed = "bed";
  scene.procedure.fat = "fat";
  scene.procedure.divide = {{"cystic_duct", 2, 1, true}, {"cystic_artery", 2, 1, true}};
  return scene;
}

AttemptFigures figuresAt(Phase phase) {
  AttemptFigures figures;
  figures.hand[0].instrument = InstrumentKind::grasper;
  figures.hand[1].instrument = InstrumentKind::hook;
  figures.vessel.resize(3);
  figures.procedure.phase = phase;
  figures.ticks = 1000;
  figures.attached = 1.0;
  return figures;
}

TEST(Hints, FollowTheProcedure) {
  const SceneDescription scene = operation();
  AttemptFigures figures = figuresAt(Phase::identification);
  const auto hint = [&] { return hintFor(scene, "summary", figures); };
  EXPECT_EQ(hint(), "Carve the fat off Calot's triangle: pull it tight and press the cut pedal.");
  figures.hand[1].instrument = InstrumentKind::scissors;
  EXPECT_EQ(hint().rfind("Take the hook. ", 0), 0U);
  figures.procedure.triangleCleared = figures.procedure.twoStructures = 2;
  figures.procedure.lowerThirdAttached = 0.401;
  EXPECT_EQ(hint(), "Take the hook. Free the lower third of the bed: 41 % of that third is still attached.");
  figures.procedure.lowerThirdFreed = 1;  // five of six
  EXPECT_EQ(hint(), "Take the clip applier. Clip the cystic duct: 0 of 3 clips are on, 2 stay with the patient.");
  figures.hand[1].instrument = InstrumentKind::clipApplier;
  figures.procedure.criticalViewFrozen = true;
  figures.procedure.lowerThirdFreed = 0;  // frozen as it is: no way back
  figures.vessel[0].clips = 3;
  EXPECT_EQ(hint(), "Take the scissors. Cut the cystic duct between its clips: 2 stay with the patient.");
  figures.vessel[0].partings = 1;
  figures.vessel[1].clips = 1;
  EXPECT_EQ(hint(), "Clip the cystic artery: 1 of 3 clips are on, 2 stay with the patient.");
  figures.vessel[1].partings = 1;
  figures.hand[1].instrument = InstrumentKind::hook;
  figures.attached = 0.25;
  EXPECT_EQ(hint(),
            "Take the gallbladder off its bed: pull it away and burn what is stretched. 25 % is still attached.");
  figures.attached = 0.0;
  EXPECT_EQ(hint(), "Pull the gallbladder away and divide the fat that still holds it.");
  EXPECT_EQ(whatIsUndone(scene, figures), "nothing was touched");
  figures.touched = true;
  EXPECT_EQ(whatIsUndone(scene, figures), "the procedure was still at its phase identification");
  figures.hand[1].cautery = Cautery::withoutContact;
  EXPECT_EQ(hint(), "The right hook burns in the air: press the pedal on tissue only.");
  figures.procedure.phase = Phase::done;
  EXPECT_EQ(whatIsUndone(scene, figures), "");
  EXPECT_EQ(hint(), "All is done. End the attempt when you are content.");
}

TEST(Hints, TellAWatcherWhatThePerformerDoes) {
  const SceneDescription scene = operation();
  AttemptFigures figures = figuresAt(Phase::identification);
  const auto hint = [&] { return hintFor(scene, "summary", figures, true); };
  EXPECT_EQ(hint(), "Watch the performer carve the fat off Calot's triangle.");
  figures.procedure.criticalViewFrozen = true;
  EXPECT_EQ(hint(), "Watch the performer clip the cystic duct: 0 of 3 clips are on, 2 stay with the patient.");
  figures.procedure.phase = Phase::done;
  EXPECT_EQ(hint(), "The performer has done.");
}

TEST(Hints, AreTheSummaryWhereThereIsNoProcedure) {
  EXPECT_EQ(hintFor(SceneDescription{}, "Touch the liver.", AttemptFigures{}), "Touch the liver.");
  AttemptFigures figures;
  EXPECT_EQ(whatIsUndone(SceneDescription{}, figures), "nothing was touched") << "holding still is not an attempt";
  figures.touched = true;
  EXPECT_EQ(whatIsUndone(SceneDescription{}, figures), "");
}

class Texts : public ::testing::Test {
 protected:
  void SetUp() override { QLocale::setDefault(QLocale::c()); }
  void TearDown() override { QLocale::setDefault(QLocale::c()); }
  static TrainingStatus running() {
    TrainingStatus status;
    status.stage = Stage::running;
    status.attempt = std::string("one");
    status.file = "/data/cholecystectomy.h5";
    status.figures = figuresAt(Phase::clipping);
    status.figures.time = 62.56;
    status.figures.procedure.errorCount = {2, 0, 1};
    return status;
  }
};

TEST_F(Texts, ForceAndDepthAreSaidWhereTheTaskIsAboutThem) {
  TrainingStatus status = running();
  status.figures.hand[1].force = 0.42;
  status.figures.hand[1].depth = 0.0061;
  status.figures.hand[1].greatestForce = 1.24;
  const auto right = [&](const SceneDescription& scene, recorder::Mode mode) {
    return panelText(status, scene, "", mode, std::nullopt).hand[1].toStdString();
  };
  expectHolds(right(SceneDescription{}, recorder::Mode::practice), {"6 mm", "0.4 N", "1.2 N"});
  EXPECT_EQ(right(operation(), recorder::Mode::practice).find(" N"), std::string::npos);
  EXPECT_EQ(right(SceneDescription{}, recorder::Mode::assessment).find(" N"), std::string::npos) << "a score";
}

TEST_F(Texts, ACountdownIsSaid) {
  TrainingStatus status = running();
  status.stage = Stage::countdown;
  status.countdown = 3;
  EXPECT_EQ(panelText(status, operation(), "", recorder::Mode::practice, std::nullopt).stage,
            QString::fromUtf8("Going on in 3 …"));
}

TEST_F(Texts, SayWhatRuns) {
  TrainingStatus status = running();
  status.figures.hand[1] = {InstrumentKind::clipApplier, 0.0, true, 1, Cautery::off};
  const PanelText text = panelText(status, operation(), "", recorder::Mode::practice, Hand::right);
  EXPECT_EQ(text.stage, QString::fromUtf8("● Recording"));
  EXPECT_EQ(text.mode, "Practice");
  EXPECT_EQ(text.time, "1:02.5") << "a clock does not round up";
  EXPECT_EQ(text.technical, "Forces on time");
  EXPECT_EQ(text.late, "");
  EXPECT_EQ(text.phase, "Phase: clipping");
  EXPECT_EQ(text.score, "Critical view 0 of 6\nErrors: 1 critical, 2 minor");
  EXPECT_FALSE(text.hint.isEmpty());
  EXPECT_EQ(text.hand[0], "Left: grasper");
  EXPECT_EQ(text.hand[1], QString::fromUtf8("▶ Right: clip applier, 1 clip left, holds tissue"));
  EXPECT_EQ(text.result, "");
}

TEST_F(Texts, AnAssessmentHasNeitherHintsNorScore) {
  const PanelText text = panelText(running(), operation(), "summary", recorder::Mode::assessment, std::nullopt);
  EXPECT_EQ(text.mode, "Assessment");
  EXPECT_EQ(text.hint, "");
  EXPECT_EQ(text.score, "");
  EXPECT_EQ(text.phase, "Phase: clipping");
}

TEST_F(Texts, SyntheticOperatorsAreMarked) {
  TrainingStatus status = running();
  status.operatorKind = recorder::OperatorKind::performer;
  EXPECT_EQ(panelText(status, operation(), "", recorder::Mode::practice, std::nullopt).mode, "Practice, synthetic");
}

TEST_F(Texts, LateForcesAndALostDeviceAreTold) {
  TrainingStatus status = running();
  status.figures.ticks = 20000;
  status.figures.missedDeadlines = 30;
  PanelText text = panelText(status, operation(), "", recorder::Mode::practice, std::nullopt);
  EXPECT_EQ(text.technical, "30 forces late (0.15 %)");
  EXPECT_EQ(text.late, "") << "long ago";
  status.figures.missedLately = 9;
  EXPECT_EQ(panelText(status, operation(), "", recorder::Mode::practice, std::nullopt).late, "")
      << "nobody feels these";
  status.figures.missedLately = 10;
  status.figures.stretched = 1.25;
  text = panelText(status, operation(), "", recorder::Mode::practice, std::nullopt);
  expectHolds(text.late.toStdString(), {"too slow"});
  EXPECT_TRUE(text.technical.startsWith("30 forces late (0.15 %)\nClock slowed by 1.")) << text.technical.toStdString();
  status.waiting = true;
  EXPECT_EQ(panelText(status, operation(), "", recorder::Mode::practice, std::nullopt).stage,
            QString::fromUtf8("Waiting for the device …"));
}

TEST_F(Texts, TheEndNamesOutcomeAndFile) {
  TrainingStatus status = running();
  status.stage = Stage::ended;
  status.report.outcome = recorder::Outcome::timeLimit;
  status.parent = std::string("one");
  status.branchedAt = 40.0;
  const PanelText text = panelText(status, operation(), "", recorder::Mode::practice, std::nullopt);
  EXPECT_EQ(text.result,
            "Outcome: time limit, after 1:02.5.\nA branch, from 0:40.0 on.\nRecorded in /data/cholecystectomy.h5");
  status.locked = false;
  const PanelText unlocked = panelText(status, operation(), "", recorder::Mode::practice, std::nullopt);
  EXPECT_TRUE(unlocked.result.endsWith(".h5, without a lock, which its file system does not grant"));
  EXPECT_EQ(text.hint, "");
}

TEST_F(Texts, AnAttemptThatWasAbandonedSaysWhy) {
  TrainingStatus status = running();
  status.stage = Stage::ended;
  status.report.outcome = recorder::Outcome::abandoned;
  status.undone = std::string("nothing was touched");
  const PanelText text = panelText(status, operation(), "", recorder::Mode::practice, std::nullopt);
  EXPECT_TRUE(text.result.startsWith("Outcome: abandoned, after 1:02.5: nothing was touched.\n"))
      << text.result.toStdString();
}

TEST_F(Texts, AnExchangeIsShownWhileItLasts) {
  TrainingStatus status = running();
  status.exchange[1] = {InstrumentKind::scissors, 1200};
  const PanelText text = panelText(status, operation(), "", recorder::Mode::practice, Hand::right);
  EXPECT_EQ(text.hand[1], QString::fromUtf8("▶ Right: gets the scissors in 2 s"));
  EXPECT_EQ(text.hand[0], "Left: grasper");
}

TEST_F(Texts, TheAssistantIsNamedWhereItCanBeAsked) {
  TrainingStatus status = running();
  const auto assistant = [&] {
    return panelText(status, operation(), "", recorder::Mode::assessment, Hand::right).assistant;
  };
  EXPECT_EQ(assistant(), "");
  status.figures.retraction = 0.009;
  EXPECT_EQ(assistant(), "Assistant: retracts 9 mm");
}

TEST_F(Texts, WhoHasTheMouseAndWhatChangesIt) {
  TrainingStatus status = running();
  const auto say = [&](recorder::Mode mode, Pointer pointer) {
    return panelText(status, operation(), "", mode, Hand::right, pointer).pointer;
  };
  EXPECT_EQ(say(recorder::Mode::practice, Pointer::elsewhere), "");
  EXPECT_TRUE(say(recorder::Mode::practice, Pointer::held).contains("Escape pauses and frees it"));
  EXPECT_TRUE(say(recorder::Mode::assessment, Pointer::held).contains("Escape frees it"));
  EXPECT_TRUE(say(recorder::Mode::assessment, Pointer::bounded).contains("Ctrl"));
  EXPECT_TRUE(say(recorder::Mode::assessment, Pointer::free).contains("Click the picture"));
  EXPECT_TRUE(say(recorder::Mode::assessment, Pointer::windowLeft).contains("the clock runs on"));
  status.stage = Stage::paused;
  EXPECT_TRUE(say(recorder::Mode::practice, Pointer::windowLeft).contains("lost the keyboard"));
  EXPECT_EQ(say(recorder::Mode::practice, Pointer::elsewhere), "");
}

TEST_F(Texts, NumbersFollowTheLocale) {
  QLocale::setDefault(QLocale(QLocale::German, QLocale::Germany));
  TrainingStatus status = running();
  status.figures.ticks = 2000000;
  status.figures.missedDeadlines = 3000;
  const PanelText text = panelText(status, operation(), "", recorder::Mode::practice, std::nullopt);
  EXPECT_EQ(text.time, "1:02,5");
  EXPECT_EQ(text.technical, "3.000 forces late (0,15 %)");
}

TEST(KeyBindings, EveryKeyOnceAndEveryControlHasOne) {
  std::set<recorder::MouseControl> controls;
  std::set<std::pair<InstrumentKind, bool>> mounts;
  std::set<recorder::ScopeControl> scope;
  for (int key = 0x20; key <= 0x01000100; key = key == 0xff ? 0x01000000 : key + 1) {
    const std::optional<KeyAction> action = actionOf(key);
    if (!action) continue;
    if (action->kind == KeyAction::Kind::control) {
      EXPECT_TRUE(controls.insert(action->control).second) << key;
    }
    if (action->kind == KeyAction::Kind::scope) {
      EXPECT_TRUE(scope.insert(action->scope).second) << key;
    }
    if (action->kind == KeyAction::Kind::mount) {
      EXPECT_TRUE(mounts.emplace(action->instrument, action->otherHand).second) << key;
    }
  }
  EXPECT_EQ(controls.size(), recorder::mouseControls);
  EXPECT_EQ(scope.size(), 10U) << "five joints, both ways";
  EXPECT_EQ(keyHelp(true, true, false).size(), keyHelp(true, false, false).size() + 5) << "told where it moves";
  EXPECT_EQ(mounts.size(), 2 * instruments().size()) << "every instrument for either hand";
  ASSERT_TRUE(actionOf(Qt::Key_X) && actionOf(Qt::Key_C));
  EXPECT_EQ(actionOf(Qt::Key_X)->kind, KeyAction::Kind::retraction);
  EXPECT_TRUE(actionOf(Qt::Key_X)->more);
  EXPECT_FALSE(actionOf(Qt::Key_C)->more);
  EXPECT_FALSE(actionOf(Qt::Key_Tab)) << "leads out of the picture";
}

TEST(KeyBindings, HelpNamesEveryInstrumentInTheOrderOfItsKeys) {
  const auto what = [](const std::vector<KeyHelp>& help, const std::string& keys) -> std::string {
    for (const KeyHelp& row : help) {
      if (row.keys.rfind(keys, 0) == 0) return row.what;
    }
    return "(no such row)";
  };
  const std::vector<KeyHelp> mouse = keyHelp(true, false, false), device = keyHelp(false, false, false);
  EXPECT_EQ(what(mouse, "1 2 3 4 9").rfind("grasper, hook, clip applier, scissors, probe", 0), 0U);
  EXPECT_EQ(what(device, "1 2 3 4 9").rfind("right hand: grasper, hook, clip applier, scissors, probe", 0), 0U);
  EXPECT_EQ(what(mouse, "5 6 7 8 0"), "the same for the other hand");
  EXPECT_EQ(what(device, "5 6 7 8 0"), "the same for the left hand");
  for (const InstrumentDefinition* each : instruments())
    EXPECT_NE(what(mouse, "1 2 3 4 9").find(each->word), std::string::npos) << each->word;
}

}  // namespace
}  // namespace calot::gui
