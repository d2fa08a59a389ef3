// SPDX-License-Identifier: GPL-3.0-or-later
// The pages as a user goes through them, with recordings and with the program that assesses them.
#include <gtest/gtest.h>
#include <cmath>
#include <QApplication>

#include <filesystem>
#include <fstream>
#include <QAbstractItemModel>
#include <QCheckBox>
#include <QComboBox>
#include <QDragEnterEvent>
#include <QDropEvent>
#include <QImage>
#include <QLabel>
#include <QListWidget>
#include <QMimeData>
#include <QPushButton>
#include <QSignalSpy>
#include <QSlider>
#include <QTableView>
#include <QTest>
#include <QTextBrowser>
#include <QToolButton>
#include <QTreeView>
#include <QUndoStack>
#include <QUrl>

#include "analytics/cohort/cohort_database.h"
#include "apps/calot-dashboard/assess_program.h"
#include "gui/dashboard/attempt_page.h"
#include "gui/dashboard/attempts_page.h"
#include "gui/dashboard/dashboard_window.h"
#include "gui/dashboard/dialogs.h"
#include "gui/dashboard/family_tree_model.h"
#include "gui/dashboard/figure_panel.h"
#include "gui/dashboard/pair_page.h"
#include "gui/dashboard/study_page.h"
#include "gui/view/scene_picture_widget.h"
#include "recorder/base/errors.h"
#include "tests/gui/dashboard/support/assessed.h"
#include "tests/gui/dashboard/support/cohort.h"
#include "tests/support/message.h"

namespace calot::gui {
namespace {

namespace fs = std::filesystem;
using Access = analytics::CohortDatabase::Access;
using test::patience;

class Pages : public test::AssessedCohort {
 protected:
  static void drop(DashboardWindow& window, const QStringList& files) {
    QMimeData data;
    QList<QUrl> urls;
    for (const QString& name : files) urls += QUrl::fromLocalFile(name);
    data.setUrls(urls);
    QDragEnterEvent enter(QPoint(10, 10), Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(&window, &enter);
    QDropEvent event(QPointF(10, 10), Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(&window, &event);
  }
  /// A cohort of twelve in place of the two that were assessed. @param apart by how much every other path is longer (m)
  void makeTwelve(double apart) {
    fs::remove(root_ / "c.db");
    analytics::CohortDatabase database(file("c.db").toStdString(), Access::create);
    for (int i = 0; i < 12; ++i)
      database.storeAttempt(test::attemptNumber(i), {test::pathLength("left", 0.1 + 0.01 * i + apart * (i % 2))});
  }
};

TEST_F(Pages, RecordingsThatAreDroppedAreAssessedAndShown) {
  fs::remove(root_ / "c.db");
  std::ofstream(root_ / "hostile.h5") << "\x89HDF\r\n\x1a\n and then nothing that belongs there";
  DashboardWindow window(apps::assessProgram());
  window.show();
  drop(window, {file("one.h5")});
  expectHolds(child<QLabel>(window, "problem")->text().toStdString(), {"cohort database"});
  ASSERT_TRUE(window.createDatabase(file("c.db")));
  EXPECT_TRUE(child<QLabel>(window, "greeting")->text().contains("Import recordings"));
  drop(window, {file("one.h5"), file("hostile.h5"), file("two.h5")});
  const QListWidget& results = *child<QListWidget>(window, "import-results");
  const QAbstractItemModel& rows = *child<QTableView>(window, "attempts")->model();
  ASSERT_TRUE(QTest::qWaitFor([&] { return rows.rowCount() == 2 && !window.imports().busy(); }, patience));
  ASSERT_EQ(results.count(), 3);
  EXPECT_TRUE(results.item(0)->text().startsWith(QString::fromUtf8("one.h5: ✓ verified; ")));
  EXPECT_TRUE(results.item(1)->text().startsWith(QString::fromUtf8("hostile.h5: ✕ damaged")))
      << results.item(1)->text().toStdString();
  drop(window, {file("two.h5")});
  ASSERT_TRUE(QTest::qWaitFor([&] { return results.count() == 4; }, patience));
  EXPECT_TRUE(results.item(3)->text().startsWith(QString::fromUtf8("two.h5: ✓ verified; ")));
}

TEST_F(Pages, AClickOnAFigureShowsTheMomentThatMadeMostOfIt) {
  DashboardWindow window(apps::assessProgram());
  window.show();
  ASSERT_TRUE(window.openDatabase(file("c.db")));
  AttemptPage& page = openAttempt(window);
  ASSERT_TRUE(page.replay().isOpen());
  EXPECT_GT(child<ScenePictureWidget>(page, "scene")->shown(), 0U);
  QTreeView& table = *child<QTreeView>(page, "attempt-checkpoints");
  const auto& tree = dynamic_cast<const FamilyTreeModel&>(*table.model());
  const auto& model = page.figures().figures();
  int row = 0;
  while (row < model.rowCount() && (model.moments(row) == nullptr || model.moments(row)->moments.empty() ||
                                    model.moments(row)->moments[0].begin < 0.5))
    ++row;
  ASSERT_LT(row, model.rowCount()) << "no figure has a moment after its begin";
  const analytics::Moment* most = &model.moments(row)->moments[0];
  for (const analytics::Moment& moment : model.moments(row)->moments) {
    if (moment.share > most->share) most = &moment;
  }
  table.scrollTo(tree.indexOf(row));
  QTest::mouseClick(table.viewport(), Qt::LeftButton, {}, table.visualRect(tree.indexOf(row)).center());
  const double wanted = most->begin - MomentCycle::leadIn;
  EXPECT_TRUE(QTest::qWaitFor(
      [&] {
        const PlayerPosition& at = page.replay().position();
        return at.settled && at.time > wanted && at.time < wanted + 0.011;
      },
      patience))
      << "wanted " << wanted << ", shows " << page.replay().position().time;
}

TEST_F(Pages, TheReplayIsScrubbedSteppedAndPlayed) {
  DashboardWindow window(apps::assessProgram());
  window.show();
  ASSERT_TRUE(window.openDatabase(file("c.db")));
  AttemptPage& page = openAttempt(window);
  const auto shows = [&](std::uint64_t step) {
    return QTest::qWaitFor([&] { return page.replay().position().settled && page.replay().position().step == step; },
                           patience);
  };
  const std::uint64_t steps = page.replay().position().steps;
  child<QSlider>(page, "scrub")->setValue(5000);
  EXPECT_TRUE(shows(steps / 2));
  QTest::mouseClick(child<QToolButton>(page, "step-forward"), Qt::LeftButton);
  EXPECT_TRUE(shows(steps / 2 + 1));
  page.setFocus();
  QTest::keyClick(&page, Qt::Key_Comma);
  QTest::keyClick(&page, Qt::Key_Comma);
  EXPECT_TRUE(shows(steps / 2 - 1));
  child<QComboBox>(page, "speed")->setCurrentIndex(7);
  QTest::mouseClick(child<QToolButton>(page, "play"), Qt::LeftButton);
  EXPECT_TRUE(shows(steps - 1)) << "plays to its end";
  EXPECT_TRUE(QTest::qWaitFor([&] { return !page.replay().position().playing; }, patience));
}

TEST_F(Pages, ARecordingThatIsNotThereIsSaidAndAskedFor) {
  fs::create_directories(root_ / "elsewhere");
  for (const char* name : {"one.h5", "two.h5"}) fs::rename(root_ / name, root_ / "elsewhere" / name);
  DashboardWindow window(apps::assessProgram());
  window.show();
  ASSERT_TRUE(window.openDatabase(file("c.db")));
  AttemptPage& page = openAttempt(window);
  EXPECT_FALSE(page.replay().isOpen());
  EXPECT_TRUE(child<QPushButton>(page, "find-recording")->isVisibleTo(&page));
  EXPECT_GT(child<QTreeView>(page, "attempt-checkpoints")->model()->rowCount(), 0) << "the checkpoints stand";
  // Once it is known where recordings are, it is found there.
  settings::rememberRecordingFolder(file("elsewhere"));
  DashboardWindow again(apps::assessProgram());
  again.show();
  ASSERT_TRUE(again.openDatabase(file("c.db")));
  EXPECT_TRUE(openAttempt(again).replay().isOpen());
}

TEST_F(Pages, AnAttemptIsExcludedAndThatIsUndone) {
  DashboardWindow window(apps::assessProgram());
  window.show();
  ASSERT_TRUE(window.openDatabase(file("c.db")));
  const auto excluded = [&] {
    int count = 0;
    const analytics::CohortDatabase database(file("c.db").toStdString(), Access::read);
    for (const analytics::AttemptRow& attempt : database.listAttempts()) count += attempt.excluded ? 1 : 0;
    return count;
  };
  // Written on a thread of its own; then the cohort is read again.
  QSignalSpy shown(&window, &DashboardWindow::documentShown);
  window.excludeOrInclude("the light failed", "R1");
  ASSERT_TRUE(shown.wait(patience));
  EXPECT_EQ(excluded(), 1);
  EXPECT_TRUE(child<QLabel>(*window.findChild<AttemptsPage*>(), "identity")->text().contains("the light failed"));
  QUndoStack& undo = *window.findChild<QUndoStack*>();
  undo.undo();
  ASSERT_TRUE(shown.wait(patience));
  EXPECT_EQ(excluded(), 0);
  undo.redo();
  ASSERT_TRUE(shown.wait(patience));
  EXPECT_EQ(excluded(), 1);
  window.excludeOrInclude("it was another light", "R1");
  ASSERT_TRUE(shown.wait(patience));
  EXPECT_EQ(excluded(), 0) << "an excluded one is taken in again";
}

TEST_F(Pages, AttemptsAreTaggedAndFoundByIt) {
  DashboardWindow window(apps::assessProgram());
  window.show();
  ASSERT_TRUE(window.openDatabase(file("c.db")));
  QTableView& table = *child<QTableView>(window, "attempts");
  QComboBox& tag = *child<QComboBox>(window, "tag");
  const int all = table.model()->rowCount();
  ASSERT_GT(all, 1);
  EXPECT_FALSE(tag.isEnabled()) << "there are none";
  QSignalSpy shown(&window, &DashboardWindow::documentShown);
  window.tagSelected("teaching", true, "R1");
  ASSERT_TRUE(shown.wait(patience));
  ASSERT_EQ(tag.findText("teaching"), 1);
  tag.setCurrentIndex(1);
  ASSERT_EQ(table.model()->rowCount(), 1);
  EXPECT_EQ(table.model()->index(0, AttemptTableModel::tagsColumn).data().toString(), "teaching");
  table.selectAll();
  window.tagSelected("teaching", true, "R1");  // has it
  ASSERT_TRUE(shown.wait(patience));
  QUndoStack& undo = *window.findChild<QUndoStack*>();
  undo.undo();
  ASSERT_TRUE(shown.wait(patience));
  EXPECT_EQ(table.model()->rowCount(), 1) << "what changed nothing takes nothing back";
  undo.undo();
  ASSERT_TRUE(shown.wait(patience));
  EXPECT_EQ(table.model()->rowCount(), all) << "the tag is gone, and with it the filter";
  const analytics::CohortDatabase database(file("c.db").toStdString(), Access::read);
  for (const analytics::AttemptRow& attempt : database.listAttempts()) EXPECT_TRUE(attempt.tags.empty());
}

TEST_F(Pages, WhatCannotBeDecidedIsSaidAndLeavesNothingToUndo) {
  DashboardWindow window(apps::assessProgram());
  window.show();
  ASSERT_TRUE(window.openDatabase(file("c.db")));
  fs::remove(root_ / "c.db");
  window.tagSelected("teaching", true, "R1");
  QLabel& problem = *child<QLabel>(window, "problem");
  EXPECT_TRUE(QTest::qWaitFor([&] { return !problem.isHidden(); }, patience));
  EXPECT_TRUE(problem.text().contains("c.db")) << problem.text().toStdString();
  QUndoStack& undo = *window.findChild<QUndoStack*>();
  undo.undo();
  EXPECT_FALSE(undo.canRedo());
  EXPECT_FALSE(undo.canUndo());
}

TEST_F(Pages, TwoRecordingsGoInStep) {
  DashboardWindow window(apps::assessProgram());
  window.show();
  ASSERT_TRUE(window.openDatabase(file("c.db")));
  showPage(window, 6);
  PairPage& page = *window.findChild<PairPage*>();
  page.chooseTwo();
  child<QComboBox>(page, "left-attempt")->setCurrentIndex(1);
  child<QComboBox>(page, "right-attempt")->setCurrentIndex(2);
  const auto times = [&] { return std::array{page.replay(0).position().time, page.replay(1).position().time}; };
  ASSERT_TRUE(
      QTest::qWaitFor([&] { return page.settled() && child<QSlider>(page, "pair-scrub")->isEnabled(); }, patience));
  child<QSlider>(page, "pair-scrub")->setValue(3333);
  EXPECT_TRUE(QTest::qWaitFor(
      [&] { return std::abs(times()[0] - 1.0) < 0.011 && std::abs(times()[0] - times()[1]) < 1e-9; }, patience))
      << times()[0] << ' ' << times()[1];
  QTest::mouseClick(child<QToolButton>(page, "pair-play"), Qt::LeftButton);
  EXPECT_TRUE(QTest::qWaitFor(
      [&] {
        const auto at = std::array{page.replay(0).position(), page.replay(1).position()};
        return at[0].step + 1 == at[0].steps && at[1].step + 1 == at[1].steps;
      },
      patience))
      << "each to its own end";
}

TEST_F(Pages, AStudyIsShownAndExported) {
  makeTwelve(0.2);
  DashboardWindow window(apps::assessProgram());
  window.show();
  ASSERT_TRUE(window.openDatabase(file("c.db")));
  StudyPage& page = *window.findChild<StudyPage*>();
  QSignalSpy shown(&page, &StudyPage::studyShown);
  showPage(window, 4);
  ASSERT_TRUE(shown.wait(patience));
  ASSERT_TRUE(page.ready()) << child<QLabel>(page, "study-state")->text().toStdString();
  const QString text = child<QTextBrowser>(page, "study-text")->toPlainText();
  EXPECT_TRUE(text.contains("SYNTHETIC")) << text.toStdString();
  EXPECT_TRUE(text.contains("skilled"));
  EXPECT_EQ(child<QComboBox>(page, "study-row")->count(), 1);
  EXPECT_TRUE(child<QLabel>(page, "study-effect")->text().replace(QChar(QChar::Nbsp), ' ').contains("A = "));
  QSignalSpy written(&page, &StudyPage::written);
  page.write(file("study.html"), true);
  ASSERT_TRUE(written.wait(patience));
  page.write(file("csv"), false);
  ASSERT_TRUE(written.wait(patience));
  EXPECT_TRUE(fs::exists(root_ / "study.html"));
  for (const char* name : {"study.csv", "values.csv", "flow.csv"})
    EXPECT_TRUE(fs::exists(root_ / "csv" / name)) << name;
  child<QCheckBox>(page, "study-synthetic")->click();
  ASSERT_TRUE(shown.wait(patience));
  EXPECT_FALSE(page.ready());
  EXPECT_FALSE(child<QLabel>(page, "study-state")->text().isEmpty());
}

TEST_F(Pages, AStudyIsBrokenOffAndBegunAgain) {
  makeTwelve(0.0);
  DashboardWindow window(apps::assessProgram());
  window.show();
  ASSERT_TRUE(window.openDatabase(file("c.db")));
  StudyPage& page = *window.findChild<StudyPage*>();
  QSignalSpy shown(&page, &StudyPage::studyShown);
  showPage(window, 4);
  // Its answer comes by the event loop, which has not run since.
  ASSERT_TRUE(page.busy());
  child<QPushButton>(page, "work-cancel")->click();
  EXPECT_FALSE(page.busy());
  EXPECT_FALSE(page.ready());
  EXPECT_TRUE(child<QLabel>(page, "study-state")->text().startsWith("Cancelled"));
  QTest::qWait(200);
  EXPECT_EQ(shown.count(), 0) << "what was broken off is not shown";
  window.reload();
  ASSERT_TRUE(shown.wait(patience));
  EXPECT_TRUE(page.ready());
}

TEST_F(Pages, PicturesOfAllPagesAreWritten) {
  DashboardWindow window(apps::assessProgram(), {fs::path(CALOT_SOURCE_DIR) / "assets"});
  window.show();
  ASSERT_TRUE(window.openDatabase(file("c.db")));
  window.savePictures(folder_.path());
  for (const char* name : {"attempts.png", "attempt.png", "compare.png", "study.png", "trainee.png", "pair.png",
                           "ratings.png", "course.png", "norm.png", "settings.png"})
    EXPECT_GT(QImage(file(name)).width(),
              std::string(name) == "settings.png" || std::string(name) == "norm.png" ? 400 : 600)
        << name;
  EXPECT_THROW(window.savePictures(file("missing")), Error);
}

}  // namespace
}  // namespace calot::gui
