// SPDX-License-Identifier: GPL-3.0-or-later
// Drives the dashboard as a user would, on Qt's offscreen platform.
#include "gui/dashboard/dashboard_window.h"

#include <gtest/gtest.h>

#include <SQLiteCpp/SQLiteCpp.h>
#include <filesystem>
#include <fstream>
#include <QAbstractItemModel>
#include <QApplication>
#include <QCheckBox>
#include <QComboBox>
#include <QImage>
#include <QLabel>
#include <QLineEdit>
#include <QLocale>
#include <QTableView>
#include <QTest>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/cohort/embedded.h"
#include "apps/calot-dashboard/assess_program.h"
#include "gui/attempt/figure_text.h"
#include "gui/dashboard/attempts_page.h"
#include "gui/dashboard/checkpoint_table_model.h"
#include "tests/gui/dashboard/support/cohort.h"
#include "tests/gui/dashboard/support/recorded.h"
#include "tests/support/fault.h"

namespace calot::gui {
namespace {

using analytics::AttemptRecord;
using analytics::CheckpointValue;
using analytics::CohortDatabase;
using analytics::Verdict;

using test::attemptNumber;
using test::pathLength;

class Dashboard : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { test::startApplication(); }

  void SetUp() override {
    QLocale::setDefault(QLocale::c());
    folder_ = std::filesystem::path(::testing::TempDir()) /
              (std::string("calot_dashboard_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] QString file(const char* name) const { return QString::fromStdString((folder_ / name).string()); }

  // Eight performers and one person whose attempt diverged.
  QString cohort() {
    CohortDatabase database(file("cohort.db").toStdString(), CohortDatabase::Access::create);
    for (int i = 0; i < 8; ++i)
      database.storeAttempt(attemptNumber(i),
                            {pathLength("left", 0.1 + 0.01 * i), pathLength("right", 0.2 + 0.01 * i)});
    AttemptRecord person = attemptNumber(100);
    person.operatorKind = recorder::OperatorKind::human;
    person.profile.clear();
    person.profileVersion.clear();
    person.synthetic = false;
    person.participant = "P07";
    person.verification = {Verdict::diverged, "step 412, component solid, field velocity", "calot 0.1.0"};
    person.startUtc = "2026-04-02T08:30:00Z";
    database.storeAttempt(
        person, {pathLength("left", 0.5),
                 analytics::makeMissing(*analytics::findCheckpoint("path-length"), "right", analytics::Origin::samples,
                                        analytics::Availability::notApplicable, "no instrument in the right hand")});
    return file("cohort.db");
  }

  template <class T>
  static T* child(const QWidget& window, const char* name) {
    T* const found = window.findChild<T*>(name);
    EXPECT_NE(found, nullptr) << name;
    return found;
  }
  static QString cell(const QTableView& table, int row, int column) {
    return table.model()->index(row, column).data(Qt::DisplayRole).toString();
  }
  static bool shows(const DashboardWindow& window, const QWidget& widget) { return widget.isVisibleTo(&window); }

  std::filesystem::path folder_;
};

TEST_F(Dashboard, OpensACohortAndListsItsAttempts) {
  DashboardWindow window(apps::assessProgram());
  window.show();
  ASSERT_TRUE(window.openDatabase(cohort())) << child<QLabel>(window, "problem")->text().toStdString();
  const QTableView& table = *child<QTableView>(window, "attempts");
  ASSERT_EQ(table.model()->rowCount(), 9);
  // Newest first.
  EXPECT_EQ(cell(table, 0, AttemptTableModel::operatorColumn), "P07");
  EXPECT_EQ(cell(table, 0, AttemptTableModel::startColumn), startText("2026-04-02T08:30:00Z"));
  EXPECT_EQ(cell(table, 0, AttemptTableModel::verificationColumn), QString::fromUtf8("≠ diverged"));
  EXPECT_EQ(cell(table, 0, AttemptTableModel::syntheticColumn), "");
  EXPECT_EQ(cell(table, 1, AttemptTableModel::syntheticColumn), "synthetic");
  EXPECT_EQ(cell(table, 1, AttemptTableModel::verificationColumn), QString::fromUtf8("✓ verified"));
  EXPECT_EQ(cell(table, 1, AttemptTableModel::sceneColumn), "touch-liver");
  EXPECT_EQ(cell(table, 1, AttemptTableModel::modeColumn), "practice");
  EXPECT_EQ(cell(table, 1, AttemptTableModel::outcomeColumn), "completed");
}

TEST_F(Dashboard, SearchNarrowsTheTable) {
  DashboardWindow window(apps::assessProgram());
  window.show();
  ASSERT_TRUE(window.openDatabase(cohort()));
  const QTableView& table = *child<QTableView>(window, "attempts");
  QLineEdit* const search = child<QLineEdit>(window, "search");
  QTest::keyClicks(search, "UNSKILLED synth");
  EXPECT_EQ(table.model()->rowCount(), 4);
  EXPECT_EQ(child<QLabel>(window, "count")->text(), "4 of 9 attempts");
  QTest::keyClicks(search, " nowhere");
  EXPECT_EQ(table.model()->rowCount(), 0);
  search->clear();
  EXPECT_EQ(table.model()->rowCount(), 9);
}

TEST_F(Dashboard, FiltersByVerdictAndOrigin) {
  DashboardWindow window(apps::assessProgram());
  window.show();
  ASSERT_TRUE(window.openDatabase(cohort()));
  const QAbstractItemModel& rows = *child<QTableView>(window, "attempts")->model();
  QComboBox* const verdict = child<QComboBox>(window, "verdict");
  QTest::keyClick(verdict, Qt::Key_Down);
  EXPECT_EQ(rows.rowCount(), 8) << "verified";
  QTest::keyClick(verdict, Qt::Key_Down);
  EXPECT_EQ(rows.rowCount(), 1) << "diverged";
  child<QComboBox>(window, "operators")->setCurrentIndex(2);
  EXPECT_EQ(rows.rowCount(), 0) << "the diverged one is not synthetic";
  verdict->setCurrentIndex(0);
  EXPECT_EQ(rows.rowCount(), 8);
}

TEST_F(Dashboard, SortsByAColumn) {
  DashboardWindow window(apps::assessProgram());
  window.show();
  ASSERT_TRUE(window.openDatabase(cohort()));
  QTableView* const table = child<QTableView>(window, "attempts");
  table->sortByColumn(AttemptTableModel::operatorColumn, Qt::AscendingOrder);
  EXPECT_EQ(cell(*table, 0, AttemptTableModel::operatorColumn), "P07");
  EXPECT_EQ(cell(*table, 1, AttemptTableModel::operatorColumn), "skilled");
  EXPECT_EQ(cell(*table, 8, AttemptTableModel::operatorColumn), "unskilled");
}

TEST_F(Dashboard, SelectingAnAttemptShowsItsCheckpoints) {
  DashboardWindow window(apps::assessProgram());
  window.show();
  ASSERT_TRUE(window.openDatabase(cohort()));
  QTableView* const table = child<QTableView>(window, "attempts");
  const QTableView& details = *child<QTableView>(window, "checkpoints");
  const QWidget& page = *window.findChild<AttemptsPage*>();
  // The newest attempt is the person's.
  ASSERT_EQ(details.model()->rowCount(), 2);
  EXPECT_EQ(cell(details, 0, CheckpointTableModel::subjectColumn), "left");
  EXPECT_NE(cell(details, 1, CheckpointTableModel::valueColumn).indexOf("no instrument in the right hand"), -1);
  EXPECT_FALSE(shows(window, *child<QLabel>(page, "watermark")));
  EXPECT_TRUE(child<QLabel>(page, "badge")->text().contains("step 412, component solid, field velocity"));

  table->setFocus();
  QTest::keyClick(table, Qt::Key_Down);
  ASSERT_EQ(details.model()->rowCount(), 2);
  EXPECT_TRUE(shows(window, *child<QLabel>(page, "watermark")));
  const analytics::CheckpointDefinition& definition = *analytics::findCheckpoint("path-length");
  const double stored = 0.1 + 0.01 * 7;  // attempt 7 started last of the performers
  EXPECT_EQ(cell(details, 0, CheckpointTableModel::valueColumn),
            numberText(stored * definition.displayFactor) + ' ' + QString::fromStdString(definition.displayUnit));
  EXPECT_EQ(cell(details, 0, CheckpointTableModel::nameColumn), QString::fromStdString(definition.title));
  EXPECT_EQ(cell(details, 0, CheckpointTableModel::windowColumn), QString::fromStdString(definition.window));
  EXPECT_EQ(cell(details, 0, CheckpointTableModel::originColumn), "samples");
  EXPECT_EQ(cell(details, 0, CheckpointTableModel::versionColumn), QString::number(definition.version));
}

TEST_F(Dashboard, WordsThatAColumnIsTooNarrowForGoOnInTheNextLine) {
  DashboardWindow window(apps::assessProgram());
  window.resize(1280, 860);  // wide enough for every other column
  window.show();
  ASSERT_TRUE(window.openDatabase(cohort()));
  QTableView& details = *child<QTableView>(window, "checkpoints");
  QTest::qWait(1);  // columns take their widths
  const int column = CheckpointTableModel::nameColumn, width = details.columnWidth(column),
            height = details.rowHeight(0);
  constexpr int narrow = 80;  // pixels
  const QRect words =
      details.fontMetrics().boundingRect(QRect(0, 0, narrow, 1000), Qt::TextWordWrap, cell(details, 0, column));
  ASSERT_GT(words.height(), height) << "of a name that needs several lines";
  details.setColumnWidth(column, narrow);
  EXPECT_TRUE(QTest::qWaitFor([&] { return details.rowHeight(0) >= words.height(); }));
  QTest::keyClick(child<QTableView>(window, "attempts"), Qt::Key_Down);
  EXPECT_GE(details.rowHeight(0), words.height()) << "of another attempt";
  details.setColumnWidth(column, width);
  EXPECT_TRUE(QTest::qWaitFor([&] { return details.rowHeight(0) == height; }));
}

TEST_F(Dashboard, AnEmptyDatabaseGreetsAndExplains) {
  { const CohortDatabase made(file("empty.db").toStdString(), CohortDatabase::Access::create); }
  DashboardWindow window(apps::assessProgram());
  window.show();
  QLabel* const greeting = child<QLabel>(window, "greeting");
  EXPECT_TRUE(shows(window, *greeting));
  EXPECT_FALSE(greeting->text().contains("calot ")) << "nobody is sent to a terminal";
  ASSERT_TRUE(window.openDatabase(file("empty.db")));
  EXPECT_TRUE(shows(window, *greeting));
  EXPECT_TRUE(greeting->text().contains("empty.db"));
  EXPECT_FALSE(shows(window, *child<QLabel>(window, "problem")));
}

TEST_F(Dashboard, AnOlderCohortIsBroughtUpToDateAndACopyKept) {
  {
    SQLite::Database raw(file("old.db").toStdString(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    raw.exec(analytics::cohortMigrations()[0].sql);
    raw.exec("PRAGMA user_version = 1; PRAGMA application_id = 1130458223");
  }
  DashboardWindow window(apps::assessProgram());
  window.show();
  ASSERT_TRUE(window.openDatabase(file("old.db")));
  QLabel* const told = child<QLabel>(window, "problem");
  EXPECT_TRUE(shows(window, *told));
  EXPECT_FALSE(told->text().isEmpty());
  EXPECT_TRUE(std::filesystem::exists(folder_ / "old.db.schema-1.bak"));
  ASSERT_TRUE(window.openDatabase(file("old.db")));
  EXPECT_FALSE(shows(window, *told)) << "said once";
}

TEST_F(Dashboard, ADamagedFileIsOneLineAndKeepsWhatWasOpen) {
  std::ofstream(folder_ / "broken.db") << "This is not a database at all, however long one reads on in it.";
  DashboardWindow window(apps::assessProgram());
  window.show();
  ASSERT_TRUE(window.openDatabase(cohort()));
  for (const char* name : {"broken.db", "missing.db"}) {
    EXPECT_FALSE(window.openDatabase(file(name)));
    QLabel* const problem = child<QLabel>(window, "problem");
    EXPECT_TRUE(shows(window, *problem));
    EXPECT_TRUE(problem->text().contains(name)) << problem->text().toStdString();
    EXPECT_FALSE(problem->text().contains('\n'));
    EXPECT_EQ(child<QTableView>(window, "attempts")->model()->rowCount(), 9);
    expectFault(ErrorKind::damaged, "", {name}, [&] { const CohortDocument document(file(name).toStdString()); });
  }
  ASSERT_TRUE(window.openDatabase(file("cohort.db")));
  EXPECT_FALSE(shows(window, *child<QLabel>(window, "problem"))) << "gone with the next success";
}

TEST_F(Dashboard, ReloadShowsWhatCameInSince) {
  DashboardWindow window(apps::assessProgram());
  window.show();
  ASSERT_TRUE(window.openDatabase(cohort()));
  CohortDatabase(file("cohort.db").toStdString(), CohortDatabase::Access::write).storeAttempt(attemptNumber(50), {});
  window.reload();
  EXPECT_TRUE(QTest::qWaitFor([&] { return child<QTableView>(window, "attempts")->model()->rowCount() == 10; }, 60000));
}

TEST_F(Dashboard, CompareShowsGroupsAndMarksSyntheticOnes) {
  DashboardWindow window(apps::assessProgram());
  window.show();
  ASSERT_TRUE(window.openDatabase(cohort()));
  ASSERT_TRUE(QTest::qWaitForWindowActive(&window));
  QTest::keyClick(&window, Qt::Key_3, Qt::ControlModifier);
  ASSERT_TRUE(shows(window, *child<QComboBox>(window, "figure"))) << "Ctrl+3 turns to the page";
  QComboBox* const figure = child<QComboBox>(window, "figure");
  ASSERT_TRUE(QTest::qWaitFor([&] { return figure->count() == 2; }, 20000)) << "path length, left and right";
  const QLabel& caption = *child<QLabel>(window, "caption");
  expectNames(caption.text().toStdString(), {"8", "1", "diverged"});
  const QWidget& chart = *child<QWidget>(window, "comparison-chart");
  EXPECT_TRUE(chart.property("watermark").toBool());
  child<QCheckBox>(window, "synthetic")->click();
  expectNames(caption.text().toStdString(), {"0", "1", "diverged", "8 synthetic"});
  EXPECT_FALSE(chart.property("watermark").toBool());
}

TEST_F(Dashboard, TenThousandAttemptsAreSortedAndSearched) {
  std::vector<analytics::AttemptRow> rows(10000);
  for (int i = 0; i < 10000; ++i) static_cast<AttemptRecord&>(rows[static_cast<std::size_t>(i)]) = attemptNumber(i);
  AttemptTableModel model;
  AttemptFilter filter;
  filter.setSourceModel(&model);
  rows[5].tags = {"odd", "teaching"};
  rows[7].tags = {"teaching"};
  const analytics::CheckpointValue unsafe =
      makeValue(*analytics::findCheckpoint("critical-errors"), "", analytics::Origin::resimulated, 1.0,
                "cystic duct left open, 1:40.2");
  model.setLines(std::make_shared<const AttemptLines>(
      rows, AttemptLines::Figures{{AttemptLines::Values{{rows[7].uuid, unsafe}}, {}, {}}, {}}));
  filter.sort(AttemptTableModel::startColumn, Qt::DescendingOrder);
  filter.set({.search = "unskilled 2026-03-05"});
  EXPECT_EQ(filter.rowCount(), 0) << "the fifth of the month is an even number";
  filter.set({.search = "skilled 2026-03-05"});
  EXPECT_EQ(filter.rowCount(), 357);
  filter.set({.search = ""});
  filter.set({.tag = "teaching"});
  ASSERT_EQ(filter.rowCount(), 2);
  EXPECT_EQ(filter.index(0, AttemptTableModel::tagsColumn).data().toString(), "teaching") << "the later one first";
  EXPECT_EQ(filter.index(1, AttemptTableModel::tagsColumn).data().toString(), "odd, teaching");
  filter.set({.search = "not safe"});
  ASSERT_EQ(filter.rowCount(), 1);
  expectNames(filter.index(0, AttemptTableModel::safetyColumn).data().toString().toStdString(),
              {"safe", "cystic duct", "1:40.2"});
  EXPECT_EQ(filter.index(0, AttemptTableModel::tagsColumn).data().toString(), "teaching");
  filter.set({.tag = "teaching"});
  EXPECT_TRUE(filter.index(1, AttemptTableModel::safetyColumn).data().toString().startsWith("not")) << "never none";
  filter.set({.tag = "teach"});
  EXPECT_EQ(filter.rowCount(), 0) << "a tag is a whole word";
  filter.set({.search = "odd"});
  EXPECT_EQ(filter.rowCount(), 1) << "the search finds tags, too";
}

TEST_F(Dashboard, NumbersFollowTheLocaleButAreNeverReadBack) {
  EXPECT_EQ(numberText(1234.4), "1234");
  EXPECT_EQ(numberText(0.0123456), "0.01235");
  EXPECT_EQ(numberText(0.0), "0");
  EXPECT_EQ(numberText(-1.6e-11), "0");
  QLocale::setDefault(QLocale(QLocale::German, QLocale::Germany));
  EXPECT_EQ(numberText(12.5), "12,50");
  DashboardWindow window(apps::assessProgram());
  window.show();
  ASSERT_TRUE(window.openDatabase(cohort()));
  EXPECT_TRUE(cell(*child<QTableView>(window, "checkpoints"), 0, CheckpointTableModel::valueColumn).contains(','));
}

}  // namespace
}  // namespace calot::gui
