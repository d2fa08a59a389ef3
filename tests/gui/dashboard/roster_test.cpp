// SPDX-License-Identifier: GPL-3.0-or-later
// The list of attempts as a roster: the latest of each person, how they do over time, groups edited in place.
#include <gtest/gtest.h>
#include <QAction>
#include <QApplication>
#include <QComboBox>
#include <QLineEdit>
#include <QSignalSpy>
#include <QTableView>
#include <QTemporaryDir>
#include <QTest>

#include "apps/calot-dashboard/assess_program.h"
#include "gui/dashboard/attempts_page.h"
#include "gui/dashboard/dashboard_window.h"
#include "gui/dashboard/dialogs.h"
#include "recorder/base/csv.h"
#include "tests/gui/dashboard/support/cohort.h"
#include "tests/gui/dashboard/support/recorded.h"
#include "tests/support/message.h"

namespace calot::gui {
namespace {

using Access = analytics::CohortDatabase::Access;
using Model = AttemptTableModel;

/// P1 tries four times, with 2, 2, 1 and no critical errors; P2 once; a performer twice.
class Roster : public testing::Test {
 protected:
  void SetUp() override {
    test::startApplication();
    path_ = folder_.filePath("c.db");
    analytics::CohortDatabase database(path_.toStdString(), Access::create);
    const auto store = [&](int number, const char* who, double critical) {
      analytics::AttemptRecord attempt = test::attemptNumber(number);
      attempt.participant = who;
      database.storeAttempt(
          attempt, {makeValue(*analytics::findCheckpoint("critical-errors"), "", analytics::Origin::resimulated,
                              critical, critical > 0.0 ? "clip lost" : ""),
                    makeValue(*analytics::findCheckpoint("critical-view"), "", analytics::Origin::resimulated, 3.0)});
    };
    for (const int i : {0, 1, 2, 3}) store(i, "P1", std::array{2.0, 2.0, 1.0, 0.0}[static_cast<std::size_t>(i)]);
    store(4, "P2", 1.0);
    store(6, "", 0.0);
    store(8, "", 0.0);
    analytics::ParticipantChange novice;
    novice.group = "novice";
    database.setParticipant("P1", novice);
    window_ = std::make_unique<DashboardWindow>(apps::assessProgram());
    window_->show();
    ASSERT_TRUE(window_->openDatabase(path_));
    table_ = window_->findChild<QTableView*>("attempts");
    table_->sortByColumn(Model::startColumn, Qt::DescendingOrder);
  }
  [[nodiscard]] QString cell(int row, int column) const {
    return table_->model()->index(row, column).data().toString();
  }
  [[nodiscard]] int rowOf(const QString& who) const {
    for (int row = 0; row < table_->model()->rowCount(); ++row) {
      if (cell(row, Model::operatorColumn) == who) return row;
    }
    return -1;
  }
  [[nodiscard]] QAction* actionOfKey(QKeySequence::StandardKey key) const {
    for (QAction* action : window_->findChildren<QAction*>()) {
      if (action->shortcut() == QKeySequence(key)) return action;
    }
    return nullptr;
  }
  [[nodiscard]] std::string groupOfP1() const {
    return analytics::CohortDatabase(path_.toStdString(), Access::read).participants().front().group;
  }

  QTemporaryDir folder_;
  QString path_;
  std::unique_ptr<DashboardWindow> window_;
  QTableView* table_ = nullptr;
};

TEST_F(Roster, ShowsTheLatestOfEachPersonWithTheTrend) {
  EXPECT_EQ(table_->model()->rowCount(), 7);
  QTest::keyClick(window_->findChild<QComboBox*>("which"), Qt::Key_Down);
  ASSERT_EQ(table_->model()->rowCount(), 3) << "P1, P2 and the performer";
  const int row = rowOf("P1");
  ASSERT_GE(row, 0);
  EXPECT_EQ(cell(row, Model::trendColumn), "2, 1, 0 critical") << "of the last three";
  EXPECT_EQ(cell(row, Model::viewColumn), "3 of 6");
  EXPECT_FALSE(cell(row, Model::safetyColumn).isEmpty());
  EXPECT_NE(cell(row, Model::safetyColumn), cell(rowOf("P2"), Model::safetyColumn)) << "P2 has an error";
  EXPECT_EQ(cell(rowOf("P2"), Model::trendColumn), "") << "one attempt is no trend";
  EXPECT_EQ(cell(rowOf("P2"), Model::errorsColumn), "") << "major and minor ones were not stored";
}

TEST_F(Roster, GroupsAreEditedInPlaceAndUndone) {
  table_->setCurrentIndex(table_->model()->index(rowOf("P1"), Model::groupColumn));
  table_->setFocus();
  QSignalSpy shown(window_.get(), &DashboardWindow::documentShown);
  QTest::keyClick(table_, Qt::Key_F2);
  auto* const editor = table_->findChild<QLineEdit*>();
  ASSERT_NE(editor, nullptr);
  editor->selectAll();
  QTest::keyClicks(editor, "expert");
  QTest::keyClick(editor, Qt::Key_Return);
  ASSERT_TRUE(shown.wait(20000));
  EXPECT_EQ(groupOfP1(), "expert");
  EXPECT_EQ(cell(rowOf("P1"), Model::groupColumn), "expert") << "of every attempt of theirs";
  QAction* const undo = actionOfKey(QKeySequence::Undo);
  ASSERT_NE(undo, nullptr);
  expectHolds(undo->text().toStdString(), {"P1"});
  QTest::keyClick(table_, Qt::Key_Z, Qt::ControlModifier);
  ASSERT_TRUE(shown.wait(20000));
  EXPECT_EQ(groupOfP1(), "novice");
  EXPECT_FALSE(undo->isEnabled());
  QAction* const redo = actionOfKey(QKeySequence::Redo);
  ASSERT_NE(redo, nullptr);
  expectHolds(redo->text().toStdString(), {"P1"});
  const QModelIndex nobody = table_->model()->index(rowOf("skilled"), Model::groupColumn);
  EXPECT_FALSE(nobody.flags().testFlag(Qt::ItemIsEditable)) << "a performer is nobody's participant";
}

TEST_F(Roster, UndoesTheLastDecisionsOneByOne) {
  QSignalSpy shown(window_.get(), &DashboardWindow::documentShown);
  const std::string uuid = window_->findChild<AttemptsPage*>()->selected()->uuid;
  window_->excludeOrInclude("the light failed", "A. Instructor");
  ASSERT_TRUE(shown.wait(20000));
  window_->tagSelected("a&b", true, "A. Instructor");
  ASSERT_TRUE(shown.wait(20000));
  QAction* const undo = actionOfKey(QKeySequence::Undo);
  expectHolds(undo->text().toStdString(), {"a&&b", uuid.substr(0, 8)});
  const auto now = [&] { return *analytics::CohortDatabase(path_.toStdString(), Access::read).attempt(uuid); };
  EXPECT_EQ(now().tags.size(), 1U);
  QTest::keyClick(table_, Qt::Key_Z, Qt::ControlModifier);
  ASSERT_TRUE(shown.wait(20000));
  EXPECT_TRUE(now().tags.empty());
  EXPECT_TRUE(now().excluded);
  expectHolds(undo->text().toStdString(), {"exclude", uuid.substr(0, 8)});
  QTest::keyClick(table_, Qt::Key_Z, Qt::ControlModifier);
  ASSERT_TRUE(shown.wait(20000));
  EXPECT_FALSE(now().excluded);
  EXPECT_FALSE(undo->isEnabled());
}

TEST_F(Roster, IsWrittenAsItIsShown) {
  table_->setColumnHidden(Model::modeColumn, true);
  QTest::keyClick(window_->findChild<QComboBox*>("which"), Qt::Key_Down);
  window_->exportList(folder_.filePath("list.csv"));
  const CsvTable list = readCsvTable(folder_.filePath("list.csv").toStdString());
  EXPECT_EQ(list.rows.size(), 3U);
  EXPECT_EQ(std::count(list.columns.begin(), list.columns.end(), "Mode"), 0);
  EXPECT_EQ(std::count(list.columns.begin(), list.columns.end(), "Trend"), 1);
}

TEST_F(Roster, IsPrintedAsItIsShown) {
  QTest::keyClick(window_->findChild<QComboBox*>("which"), Qt::Key_Down);
  analytics::ReportDocument printed;
  ASSERT_TRUE(window_->findChild<AttemptsPage*>()->makeDocument([&](const auto& document) { printed = document; }));
  EXPECT_TRUE(printed.synthetic);
  const auto& table = std::get<analytics::ReportTable>(printed.parts.back());
  EXPECT_EQ(table.rows.size(), 3U);
  for (const auto& column : table.columns) EXPECT_NE(column.first, "Tags") << "nobody has one";
}

TEST_F(Roster, RemembersWhichCohortsWereOpened) {
  EXPECT_EQ(settings::recentCohorts().front(), path_);
  const QString other = folder_.filePath("other.db");
  ASSERT_TRUE(window_->createDatabase(other));
  EXPECT_EQ(settings::recentCohorts().mid(0, 2), (QStringList{other, path_}));
}

TEST_F(Roster, EachActionOfTheContextMenuIsInAMenuToo) {
  ASSERT_EQ(table_->contextMenuPolicy(), Qt::ActionsContextMenu);
  EXPECT_GE(table_->actions().size(), 6);
  for (const QAction* action : table_->actions())
    EXPECT_FALSE(action->shortcut().isEmpty()) << action->text().toStdString();
}

}  // namespace
}  // namespace calot::gui
