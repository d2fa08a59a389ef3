// SPDX-License-Identifier: GPL-3.0-or-later
// Drives the trainer as a trainee would, on Qt's offscreen platform.
#include "gui/trainer/trainer_window.h"

#include <gtest/gtest.h>

#include <QApplication>
#include <QImage>
#include <QLabel>
#include <QListWidget>
#include <QLocale>
#include <QMouseEvent>
#include <QPushButton>
#include <QSlider>
#include <QTest>

#include "analytics/cohort/cohort_database.h"
#include "gui/attempt/widget_parts.h"
#include "gui/trainer/end_page.h"
#include "gui/trainer/operation_view.h"
#include "gui/trainer/run_panel.h"
#include "gui/trainer/trainer_texts.h"
#include "gui/trainer/training_session.h"
#include "recorder/recording/reader.h"
#include "recorder/sources/devices/scope_device.h"
#include "recorder/sources/scope/scope_source.h"
#include "tests/gui/trainer/support/spoken.h"
#include "tests/gui/trainer/support/trainer_rig.h"
#include "tests/gui/trainer/support/trainer_window_rig.h"
#include "tests/support/fault.h"
#include "tests/support/message.h"

namespace calot::gui {
namespace {

using trainertest::expectExact;
using trainertest::patience;
using trainertest::Trainer;

TEST_F(Trainer, GreetsAndBeginsByKeyboard) {
  TrainerWindow& window = open();
  EXPECT_GE(window.height(), 720) << "as high as the picture wants, where the screen has 800 by 800 pixels";
  window.chooseScene();
  auto* const scenes = child<QListWidget>("scenes");
  ASSERT_EQ(scenes->count(), 2);
  EXPECT_EQ(scenes->item(0)->text(), "touch-liver\nA touch.");
  EXPECT_TRUE(scenes->hasFocus());
  QTest::keyClick(scenes, Qt::Key_Down);
  QTest::keyClick(scenes, Qt::Key_Return);
  EXPECT_TRUE(text("problem").contains("gone.json")) << text("problem").toStdString();
  EXPECT_EQ(window.session(), nullptr);
  QTest::keyClick(scenes, Qt::Key_Up);
  QTest::keyClick(scenes, Qt::Key_Return);
  ASSERT_NE(window.session(), nullptr);
  EXPECT_FALSE(child<QLabel>("problem")->isVisible());
  EXPECT_TRUE(window.view()->hasFocus());
  ASSERT_TRUE(runs(0.2));
  window.refresh();
  EXPECT_EQ(text("stage"), QString::fromUtf8("● Recording"));
  EXPECT_TRUE(QTest::qWaitFor([&] { return window.view()->shown() > 2; }, patience));
  const QImage picture = window.view()->picture();
  EXPECT_EQ(picture.size(), window.view()->size());
}

TEST_F(Trainer, MouseAndKeysDriveTheHands) {
  TrainerWindow& window = open();
  beginSmall();
  OperationView& view = *window.view();
  const QPoint middle = view.rect().center();
  pointTo(middle);
  pointTo(middle + QPoint(100, 0));
  hold(Qt::Key_S, [&] { return jaw() > 0.5; });
  QTest::keyClick(&view, Qt::Key_Space);
  hold(Qt::Key_Down, [&, begin = window.session()->status().figures.time] {
    return window.session()->status().figures.time > begin + 0.5;
  });
  QTest::keyClick(&view, Qt::Key_2);  // the left hand, which is driven, has the hook
  EXPECT_TRUE(QTest::qWaitFor(
      [&] { return window.session()->status().figures.hand[0].instrument == InstrumentKind::hook; }, patience));
  window.refresh();
  EXPECT_EQ(text("left"), QString::fromUtf8("▶ Left: hook"));
  EXPECT_EQ(text("right"), "Right: grasper");
  window.session()->finish();
  ASSERT_TRUE(reaches(Stage::ended));
  const std::filesystem::path file = window.session()->status().file;
  EXPECT_TRUE(text("result").contains(QString::fromStdString(file.string())));
  EXPECT_TRUE(text("result").startsWith("Outcome: abandoned")) << text("result").toStdString();
  expectHolds(text("result").toStdString(), {window_->session()->status().undone});
  expectExact(file);

  recorder::Recording recording(file);
  EXPECT_EQ(recording.header().provenance.device, "mouse");
  EXPECT_EQ(recording.header().provenance.kind, recorder::OperatorKind::human);
  const SceneDescription& scene = window.session()->scene();
  const TickSamples last = recording.step(recording.stepCount() - 1).samples.back();
  // 100 pixels to the right are 15 mm along the camera's x.
  const Vec3 right = scene.camera.orientation.conjugate() * (last.hand[1].position - scene.hands[1].home);
  EXPECT_NEAR((right - Vec3(0.015, 0, 0)).norm(), 0.0, 1e-5);
  // 0.5 s of a key are 15 mm down; the machine may be late in letting it go.
  const Vec3 left = scene.camera.orientation.conjugate() * (last.hand[0].position - scene.hands[0].home);
  EXPECT_GT(left.y(), 0.0145);
  EXPECT_NEAR(left.x(), 0.0, 1e-5);
}

/// The small scene with an assistant.
recorder::LoadedScene sceneWithAssistant() {
  std::vector<recorder::Asset> files = trainertest::smallLoadedScene().assets;
  std::string text(reinterpret_cast<const char*>(files[0].bytes.data()), files[0].bytes.size());
  text.insert(text.find("\"ticksPerStep\""),
              R"("retraction": [{"organ": "gallbladder", "centre": [0.0165, 0.0617, -0.0174], "radius": 0.02,
              "displacement": [0, 0.004, 0], "duration": 0.5, "stage": 0.5, "most": 2}], )");
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  files[0].bytes.assign(bytes, bytes + text.size());
  return recorder::sceneFromAssets(std::move(files));
}

TEST_F(Trainer, KeysAskTheAssistantForRetraction) {
  TrainerWindow& window = open();
  window.begin(sceneWithAssistant());
  ASSERT_TRUE(runs(0.1));
  const auto retracts = [&](double length) {
    return QTest::qWaitFor(
        [&] {
          const std::optional<double> now = window.session()->status().figures.retraction;
          return now && std::abs(*now - length) < 1e-9;
        },
        patience);
  };
  EXPECT_TRUE(retracts(0.004));
  QTest::keyClick(window.view(), Qt::Key_X);
  EXPECT_TRUE(retracts(0.006));
  window.refresh();
  EXPECT_EQ(text("assistant"), "Assistant: retracts 6 mm");
  EXPECT_FALSE(child<QLabel>("assistantKeys")->isHidden());
  QTest::keyClick(window.view(), Qt::Key_C);
  EXPECT_TRUE(retracts(0.004));
  window.session()->finish();
  ASSERT_TRUE(reaches(Stage::ended));
  const std::filesystem::path file = window.session()->status().file;
  expectExact(file);
  recorder::Recording recording(file);
  std::vector<EventKind> asked;
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    for (const Event& event : recording.step(n).result.events)
      if (event.kind == EventKind::retractionMore || event.kind == EventKind::retractionLess)
        asked.push_back(event.kind);
  }
  EXPECT_EQ(asked, (std::vector<EventKind>{EventKind::retractionMore, EventKind::retractionLess}));
}

TEST_F(Trainer, KeysAndPedalMoveTheEndoscope) {
  TrainerWindow& window = open(nullptr, recorder::Mode::practice, std::make_shared<recorder::ScopeInput>());
  beginSmall();
  OperationView& view = *window.view();
  const auto seconds = [&](double length) {
    return [&window, length, begin = window.session()->status().figures.time] {
      return window.session()->status().figures.time > begin + length;
    };
  };
  hold(Qt::Key_L, seconds(0.5));
  const QPoint middle = view.rect().center();
  pointTo(middle);
  QTest::keyPress(&view, Qt::Key_V);
  pointTo(middle + QPoint(0, -100));
  QTest::keyRelease(&view, Qt::Key_V);
  ASSERT_TRUE(QTest::qWaitFor(seconds(1.0), patience));
  window.session()->finish();
  ASSERT_TRUE(reaches(Stage::ended));
  const std::filesystem::path file = window.session()->status().file;
  expectExact(file);
  recorder::Recording recording(file);
  const SceneDescription& scene = window.session()->scene();
  const TickSamples last = recording.step(recording.stepCount() - 1).samples.back();
  const recorder::ScopeJoints joints = recorder::Endoscope(scene, 0.0).jointsOf(last.camera);
  // 0.5 s of a key are 0.15 rad to the right; the machine may be late in letting it go. 100 pixels are 0.15 rad up.
  EXPECT_GT(joints.pan, 0.14);
  EXPECT_NEAR(joints.tilt, 0.15, 0.002);
  EXPECT_NEAR((last.hand[1].position - scene.hands[1].home).norm(), 0.0, 1e-5) << "the pedal passed the mouse on";
}

TEST_F(Trainer, PausesListsTheMistakeAndGoesBack) {
  TrainerWindow& window = open();
  beginSmall();
  OperationView& view = *window.view();
  QTest::keyClick(&view, Qt::Key_3);  // clip applier
  ASSERT_TRUE(QTest::qWaitFor([&] { return window.session()->status().exchange[1].has_value(); }, patience));
  window.refresh();
  expectHolds(text("right").toStdString(), {"clip applier", "1 s"});
  ASSERT_TRUE(QTest::qWaitFor(
      [&] { return window.session()->status().figures.hand[1].instrument == InstrumentKind::clipApplier; }, patience));
  hold(Qt::Key_S, [&] { return jaw() > 0.5; });
  hold(Qt::Key_A, [&] { return !window.session()->status().figures.errors->empty(); });
  const TrainingStatus before = window.session()->status();
  window.refresh();
  expectHolds(view.over().error().toStdString(), {before.figures.errors->front().text});
  QTest::keyClick(&view, Qt::Key_Escape);
  ASSERT_TRUE(reaches(Stage::paused));
  EXPECT_EQ(text("stage"), QString::fromUtf8("❚❚ Paused"));
  auto* const mistakes = child<QListWidget>("mistakes");
  ASSERT_EQ(mistakes->count(), 1);
  EXPECT_TRUE(mistakes->item(0)->text().endsWith("clip lost"));
  EXPECT_TRUE(mistakes->isVisible());
  // What the mouse does meanwhile moves nothing.
  pointTo(view.rect().center());
  pointTo(view.rect().center() + QPoint(60, 60));
  QTest::keyClick(mistakes, Qt::Key_Return);
  ASSERT_TRUE(reaches(Stage::countdown));
  EXPECT_TRUE(text("stage").contains(view.over().count())) << text("stage").toStdString();
  EXPECT_FALSE(view.over().count().isEmpty());
  ASSERT_TRUE(QTest::qWaitFor([&] { return window.session()->status().parent == before.attempt; }, patience));
  ASSERT_TRUE(runs(window.session()->status().branchedAt + 0.2));
  EXPECT_TRUE(window.session()->status().figures.errors->empty()) << "it has not happened in the branch";
  window.refresh();
  EXPECT_FALSE(mistakes->isVisible());
  QTest::mouseClick(child<QPushButton>("finish"), Qt::LeftButton);
  ASSERT_TRUE(reaches(Stage::ended));
  EXPECT_TRUE(text("result").contains("branch"));
  expectExact(before.file);
  expectExact(window.session()->status().file);
  EXPECT_FALSE(child<QListWidget>("moments")->isVisible()) << "nothing went wrong in the branch";
  QTest::mouseClick(child<QPushButton>("again"), Qt::LeftButton);
  ASSERT_TRUE(runs(0.1));
  EXPECT_FALSE(window.endPage()->isVisible());
  // A busy machine draws late; two pictures after one another are a rate.
  const quint64 shown = view.shown();
  ASSERT_TRUE(QTest::qWaitFor([&] { return view.shown() >= shown + 3; }, patience));
  const std::vector<std::string> lines = window.endAndReport();
  ASSERT_EQ(lines.size(), 7U);
  EXPECT_NE(lines[4].find("stopped"), std::string::npos);
  EXPECT_NE(lines[5].find(" forces late ("), std::string::npos);
  EXPECT_NE(lines[6].find(" pictures "), std::string::npos);
}

TEST_F(Trainer, TheEndShowsFiguresMomentsAndTheReplayOfOne) {
  TrainerWindow& window = open();
  beginSmall();
  OperationView& view = *window.view();
  QTest::keyClick(&view, Qt::Key_3);
  hold(Qt::Key_S, [&] { return jaw() > 0.5; });
  hold(Qt::Key_A, [&] { return !window.session()->status().figures.errors->empty(); });
  const double mistake = window.session()->status().figures.errors->front().time;
  window.session()->finish();
  ASSERT_TRUE(reaches(Stage::ended));
  EndPage& end = *window.endPage();
  EXPECT_TRUE(end.isVisible());
  EXPECT_EQ(text("endOutcome"), text("result"));
  auto* const moments = child<QListWidget>("moments");
  ASSERT_EQ(moments->count(), 1);
  EXPECT_TRUE(moments->hasFocus());
  ASSERT_TRUE(QTest::qWaitFor([&] { return end.replay().isOpen() && end.settled(); }, patience));
  EXPECT_TRUE(text("endFigures").contains("Elapsed time")) << text("endFigures").toStdString();
  expectHolds(text("endNorm").toStdString(), {"norm"});
  EXPECT_FALSE(child<QPushButton>("store")->isVisible()) << "there is no cohort";
  QTest::mouseClick(moments->viewport(), Qt::LeftButton, {}, moments->visualItemRect(moments->item(0)).center());
  EXPECT_TRUE(QTest::qWaitFor([&] { return end.replay().position().time >= mistake; }, patience))
      << "the replay goes to the moment and on";
  QTest::mouseClick(child<QPushButton>("endScenes"), Qt::LeftButton);
  EXPECT_EQ(window.session(), nullptr);
  EXPECT_FALSE(end.replay().isOpen());
}

TEST_F(Trainer, OneButtonPutsTheAttemptIntoTheCohortVerified) {
  cohort_ = folder_ / "c.db";
  participant_ = "P7";
  TrainerWindow& window = open();
  const auto attempt = [&] {
    const QString before = QString::fromStdString(window.session()->status().attempt);
    window.session()->finish();
    EXPECT_TRUE(reaches(Stage::ended));
    EXPECT_TRUE(QTest::qWaitFor([&] { return window.endPage()->settled(); }, patience));
    return before.toStdString();
  };
  beginSmall();
  const std::string first = attempt();
  auto* const store = child<QPushButton>("store");
  ASSERT_TRUE(store->isVisible());
  QTest::mouseClick(store, Qt::LeftButton);
  EXPECT_TRUE(window.endPage()->storing());
  EXPECT_FALSE(store->isEnabled());
  ASSERT_TRUE(QTest::qWaitFor([&] { return window.endPage()->settled(); }, patience));
  EXPECT_TRUE(text("storeText").contains("verified")) << text("storeText").toStdString();
  EXPECT_FALSE(store->isEnabled()) << "it is in there";
  {
    const analytics::CohortDatabase cohort(cohort_.string(), analytics::CohortDatabase::Access::read);
    const std::optional<analytics::AttemptRow> row = cohort.attempt(first);
    ASSERT_TRUE(row);
    EXPECT_EQ(row->participant, "P7");
    EXPECT_EQ(row->verification.verdict, analytics::Verdict::verified);
    EXPECT_GT(cohort.values(first).size(), 10U);
  }
  QTest::mouseClick(child<QPushButton>("again"), Qt::LeftButton);
  ASSERT_TRUE(runs(0.2));
  attempt();
  EXPECT_TRUE(text("endPrevious").startsWith("Last time: ")) << text("endPrevious").toStdString();
  EXPECT_TRUE(text("endFigures").contains("last time: "));
  EXPECT_TRUE(store->isEnabled()) << "this one is not";
  // The greeting counts it.
  window.chooseScene();
  EXPECT_TRUE(
      QTest::qWaitFor([&] { return child<QListWidget>("scenes")->item(0)->text().contains("1 attempt"); }, patience))
      << child<QListWidget>("scenes")->item(0)->text().toStdString();
  EXPECT_EQ(child<QListWidget>("past")->count(), 1);
}

TEST_F(Trainer, AskForOneControlAfterTheOtherAndSaysWhenItWasUsed) {
  TrainerWindow& window = open();
  QStringList alerts;
  QObject::connect(window.findChild<RunPanel*>(), &RunPanel::announced, &window,
                   [&](const QString&, const QString& words) { alerts += words; });
  window.begin(trainertest::smallLoadedScene(), Purpose::controls);
  ASSERT_TRUE(runs(0.1));
  window.refresh();
  EXPECT_TRUE(text("hint").startsWith("Control 1 of 10")) << text("hint").toStdString();
  EXPECT_TRUE(child<QLabel>("assistantKeys")->isHidden()) << "the scene has none";
  const QFrame& sheet = window.view()->over().sheet();
  EXPECT_TRUE(sheet.isVisible() && sheet.isAncestorOf(child<QLabel>("hint"))) << "over the picture";
  hold(Qt::Key_Down, [&] { return text("hint").contains("Control 2 of 10"); });
  EXPECT_TRUE(text("hint").startsWith(QString::fromUtf8("✓ Done: moving")));
  QTest::keyClick(window.view(), Qt::Key_K, Qt::ControlModifier);
  EXPECT_TRUE(text("hint").startsWith("Control 3 of 10")) << text("hint").toStdString();
  hold(Qt::Key_S, [&] { return text("hint").contains("Control 4 of 10"); });
  EXPECT_TRUE(alerts.filter("Control 1 of 10").size() == 1 && alerts.filter("Control 4 of 10").size() == 1)
      << "announced once each: " << alerts.join(" | ").toStdString();
  window.begin(trainertest::smallLoadedScene());
  ASSERT_TRUE(runs(0.1));
  window.refresh();
  EXPECT_FALSE(sheet.isVisible());
  EXPECT_TRUE(window.findChild<RunPanel*>()->isAncestorOf(child<QLabel>("hint"))) << "where hints are else";
}

TEST_F(Trainer, ReadsAloudWhatItAsksForUntilItIsToldNotTo) {
  TrainerWindow& window = open();
  EXPECT_EQ(trainertest::SpokenEngine::last, nullptr) << "nobody asked for a voice";
  QTest::keyClick(&window, Qt::Key_L, Qt::ControlModifier);
  ASSERT_NE(trainertest::SpokenEngine::last, nullptr);
  trainertest::SpokenEngine& engine = *trainertest::SpokenEngine::last;
  const auto said = [&](const QString& words) {
    engine.finish();
    return !engine.begun.filter(words).isEmpty();
  };
  window.begin(trainertest::smallLoadedScene(), Purpose::controls);
  ASSERT_TRUE(QTest::qWaitFor([&] { return said("Control 1 of 10"); }, patience));
  QTest::keyClick(window.view(), Qt::Key_K, Qt::ControlModifier);
  ASSERT_TRUE(QTest::qWaitFor([&] { return said("Control 2 of 10"); }, patience));
  QTest::keyClick(&window, Qt::Key_L, Qt::ControlModifier);
  const qsizetype before = engine.begun.size();
  QTest::keyClick(window.view(), Qt::Key_K, Qt::ControlModifier);
  ASSERT_TRUE(text("hint").startsWith("Control 3 of 10")) << text("hint").toStdString();
  EXPECT_FALSE(said("Control 3 of 10"));
  EXPECT_EQ(engine.begun.size(), before);
  // What stands against it is said where it can be read.
  QTest::keyClick(&window, Qt::Key_L, Qt::ControlModifier);
  engine.fail("no sound card");
  window.refresh();
  EXPECT_TRUE(text("problem").contains("no sound card")) << text("problem").toStdString();
  EXPECT_TRUE(child<QLabel>("problem")->isVisible());
  // It may have been put right meanwhile.
  QTest::keyClick(&window, Qt::Key_L, Qt::ControlModifier);
  trainertest::SpokenEngine* const another = trainertest::SpokenEngine::last;
  ASSERT_NE(another, nullptr);
  QTest::keyClick(window.view(), Qt::Key_K, Qt::ControlModifier);
  const auto saidNow = [&] {
    another->finish();
    return another->begun.filter("Control 4 of 10").size() == 1;
  };
  EXPECT_TRUE(QTest::qWaitFor(saidNow, patience)) << "it waits for what else there is to say";
}

TEST_F(Trainer, ADemonstrationIsWatchedAndIsNoAttemptOfTheTrainee) {
  cohort_ = folder_ / "c.db";
  participant_ = "P7";
  TrainerWindow& window = open();
  window.chooseScene();
  window.begin(trainertest::smallLoadedScene(), Purpose::demonstration);
  ASSERT_TRUE(runs(0.3));
  window.refresh();
  EXPECT_FALSE(window.view()->holdsPointer()) << "nothing is to be driven";
  EXPECT_EQ(text("mode"), "Practice, synthetic");
  window.session()->finish();
  ASSERT_TRUE(reaches(Stage::ended));
  EXPECT_TRUE(child<QLabel>("endSynthetic")->isVisible());
  EXPECT_FALSE(child<QPushButton>("store")->isVisible());
  EXPECT_EQ(recorder::Recording(window.session()->status().file).header().participant, "");
  EXPECT_FALSE(text("result").contains(".h5"));
  window.chooseScene();
  EXPECT_TRUE(window.endAndReport().empty() || window.endAndReport().back().find(".h5") == std::string::npos);
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "")) << "it leaves no file";
}

TEST_F(Trainer, ABranchStandsBesideItsParentAtTheEnd) {
  TrainerWindow& window = open();
  beginSmall();
  hold(Qt::Key_Right, [&] { return window.session()->status().figures.time > 1.0; });
  ASSERT_TRUE(window.session()->goBack(0.5));
  ASSERT_TRUE(QTest::qWaitFor([&] { return !window.session()->status().parent.empty(); }, patience));
  ASSERT_TRUE(runs(0.8));
  window.session()->finish();
  ASSERT_TRUE(reaches(Stage::ended));
  ASSERT_TRUE(QTest::qWaitFor([&] { return window.endPage()->settled(); }, patience));
  EXPECT_EQ(window.findChildren<QSlider*>("pair-scrub").size(), 1);
  EXPECT_TRUE(child<QSlider>("pair-scrub")->isVisible());
  expectHolds(text("lesson").toStdString(), {"mm"});
}

TEST_F(Trainer, AnAssessmentShowsNoHintsNoScoreAndNoPause) {
  TrainerWindow& window =
      open(std::make_shared<trainertest::ScriptInput>(trainertest::swayingScript(20.0)), recorder::Mode::assessment);
  beginSmall();
  window.session()->mount(Hand::right, InstrumentKind::clipApplier);
  ASSERT_TRUE(QTest::qWaitFor([&] { return !window.session()->status().figures.errors->empty(); }, patience));
  window.refresh();
  EXPECT_EQ(text("mode"), "Assessment, synthetic");
  for (const char* name : {"hint", "score"}) EXPECT_FALSE(child<QLabel>(name)->isVisible()) << name;
  EXPECT_FALSE(child<QPushButton>("pause")->isVisible());
  QTest::keyClick(window.view(), Qt::Key_Escape);
  EXPECT_EQ(window.session()->status().stage, Stage::running);
  QTest::mouseClick(child<QPushButton>("finish"), Qt::LeftButton);
  ASSERT_TRUE(reaches(Stage::ended));
  EXPECT_FALSE(child<QListWidget>("mistakes")->isVisible()) << "mistakes are a score";
  EXPECT_TRUE(window.endPage()->isVisible());
  EXPECT_FALSE(child<QListWidget>("moments")->isVisible());
  EXPECT_FALSE(child<QLabel>("endFigures")->isVisible());
  EXPECT_TRUE(text("endNorm").contains("assessment"));
}

TEST_F(Trainer, LosingTheKeyboardLetsGoOfEverything) {
  TrainerWindow& window = open();
  beginSmall();
  QTest::keyPress(window.view(), Qt::Key_S);
  ASSERT_TRUE(QTest::qWaitFor([&] { return jaw() > 0.1; }, patience));
  child<QPushButton>("finish")->setFocus();
  const double from = window.session()->status().figures.time;
  ASSERT_TRUE(runs(from + 0.3));
  const double jawThen = jaw();
  ASSERT_TRUE(runs(from + 0.6));
  EXPECT_EQ(jaw(), jawThen) << "a key that was down for a window without focus still opens the jaws";
}

TEST_F(Trainer, ThePictureHoldsThePointerUntilAKeyFreesIt) {
  TrainerWindow& window = open(nullptr, recorder::Mode::assessment);
  beginSmall();
  OperationView& view = *window.view();
  window.refresh();
  ASSERT_TRUE(view.holdsPointer());
  EXPECT_EQ(view.cursor().shape(), Qt::BlankCursor);
  EXPECT_EQ(text("pointer"), saidOf(Pointer::held));
  // Farther than the picture is wide.
  const double wide = 1.5 * view.width();
  pointTo(view.rect().center());
  for (double x = 0.0; x < wide; x += 20.0) {
    const QPoint to = view.mapFromGlobal(QCursor::pos()) + QPoint(20, 0);
    pointTo(to);
    // The window system says where it was put back to.
    if (const QPoint now = view.mapFromGlobal(QCursor::pos()); now != to) pointTo(now);
    EXPECT_TRUE(view.rect().contains(view.mapFromGlobal(QCursor::pos())));
  }
  ASSERT_TRUE(runs(window.session()->status().figures.time + 0.6));
  QTest::keyClick(&view, Qt::Key_Escape);
  EXPECT_EQ(window.session()->status().stage, Stage::running) << "an assessment has no pause";
  EXPECT_FALSE(view.holdsPointer());
  EXPECT_EQ(text("pointer"), saidOf(Pointer::free));
  for (int i = 0; i < 5; ++i) pointTo(view.rect().center() + QPoint(0, 10 * i));
  QCoreApplication::processEvents();
  QTest::mouseClick(&view, Qt::LeftButton);
  EXPECT_TRUE(view.holdsPointer());
  ASSERT_TRUE(runs(window.session()->status().figures.time + 0.5));
  window.session()->finish();
  ASSERT_TRUE(reaches(Stage::ended));
  EXPECT_FALSE(view.holdsPointer());
  recorder::Recording recording(window.session()->status().file);
  const SceneDescription& scene = window.session()->scene();
  const TickSamples last = recording.step(recording.stepCount() - 1).samples.back();
  const Vec3 moved = scene.camera.orientation.conjugate() * (last.hand[1].position - scene.hands[1].home);
  EXPECT_GT(moved.x(), std::min(0.00015 * 0.9 * wide, 0.1)) << "the pointer came to an edge";
  EXPECT_NEAR(moved.y(), 0.0, 1e-5) << "a free pointer moved the hand";
  EXPECT_NEAR(last.hand[1].jaw, 0.0, 1e-4) << "the click that holds the pointer closes no jaws";
}

TEST_F(Trainer, PracticePausesWhereTheWindowLosesTheKeyboard) {
  TrainerWindow& window = open();
  beginSmall();
  QWidget other;
  other.show();
  other.activateWindow();
  ASSERT_TRUE(QTest::qWaitForWindowActive(&other));
  ASSERT_TRUE(reaches(Stage::paused));
  EXPECT_EQ(text("pointer"), saidOf(Pointer::windowLeft));
  EXPECT_FALSE(window.view()->holdsPointer());
  window.activateWindow();
  ASSERT_TRUE(QTest::qWaitForWindowActive(&window));
  EXPECT_EQ(window.session()->status().stage, Stage::paused) << "it goes on when the trainee says so";
  QTest::keyClick(window.view(), Qt::Key_Escape);
  ASSERT_TRUE(reaches(Stage::running));
  EXPECT_NE(text("pointer"), saidOf(Pointer::windowLeft));
}

TEST_F(Trainer, AnAssessmentSaysThatTheHandsAreLetGo) {
  TrainerWindow& window = open(nullptr, recorder::Mode::assessment);
  beginSmall();
  QTest::keyPress(window.view(), Qt::Key_S);
  ASSERT_TRUE(QTest::qWaitFor([&] { return jaw() > 0.1; }, patience));
  QWidget other;
  other.show();
  other.activateWindow();
  ASSERT_TRUE(QTest::qWaitForWindowActive(&other));
  window.refresh();
  EXPECT_EQ(window.session()->status().stage, Stage::running);
  EXPECT_EQ(text("pointer"), saidOf(Pointer::windowLeft));
  const double from = window.session()->status().figures.time;
  ASSERT_TRUE(runs(from + 0.3));
  const double jawThen = jaw();
  ASSERT_TRUE(runs(from + 0.6));
  EXPECT_EQ(jaw(), jawThen);
}

TEST_F(Trainer, ThePictureIsSavedOrTheFolderNamed) {
  TrainerWindow& window = open();
  parts::savePicture(window, QString::fromStdString((folder_ / "a.png").string()));
  EXPECT_FALSE(QImage(QString::fromStdString((folder_ / "a.png").string())).isNull());
  expectFault(ErrorKind::failure, "", {"/nowhere/a.png"}, [&] { parts::savePicture(window, "/nowhere/a.png"); });
}

}  // namespace
}  // namespace calot::gui
