// SPDX-License-Identifier: GPL-3.0-or-later
// What instructors do with the pages: read an attempt, write its sheet, choose several, follow a trainee, rate.
#include <gtest/gtest.h>
#include <cmath>
#include <QApplication>

#include <filesystem>
#include <fstream>
#include <QAction>
#include <QComboBox>
#include <QLabel>
#include <QMenu>
#include <QPushButton>
#include <QSignalSpy>
#include <QSlider>
#include <QTableView>
#include <QTableWidget>
#include <QTabWidget>
#include <QTest>
#include <QThread>
#include <QTreeView>
#include <QUndoStack>
#include <sstream>

#include "analytics/assessment/grade.h"
#include "analytics/checkpoints/checkpoint.h"
#include "analytics/cohort/blinding.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/report/key_figures.h"
#include "apps/calot-dashboard/assess_program.h"
#include "gui/attempt/long_work.h"
#include "gui/attempt/widget_parts.h"
#include "gui/dashboard/attempt_page.h"
#include "gui/dashboard/attempts_page.h"
#include "gui/dashboard/comparison.h"
#include "gui/dashboard/dashboard_window.h"
#include "gui/dashboard/dialogs.h"
#include "gui/dashboard/event_tree.h"
#include "gui/dashboard/family_tree_model.h"
#include "gui/dashboard/figure_panel.h"
#include "gui/dashboard/pair_page.h"
#include "gui/dashboard/plot_view.h"
#include "gui/dashboard/timeline.h"
#include "gui/report/pdf_report.h"
#include "gui/words/attempt_summary.h"
#include "recorder/base/errors.h"
#include "tests/gui/dashboard/support/assessed.h"
#include "tests/gui/dashboard/support/cohort.h"
#include "tests/gui/dashboard/support/recorded.h"
#include "tests/support/message.h"

namespace calot::gui {
namespace {

namespace fs = std::filesystem;
using Access = analytics::CohortDatabase::Access;
using test::patience;

class Instructor : public test::AssessedCohort {
 protected:
  void SetUp() override { test::AssessedCohort::SetUp(); }
  [[nodiscard]] std::unique_ptr<DashboardWindow> opened() const {
    auto window = std::make_unique<DashboardWindow>(apps::assessProgram(),
                                                    std::vector<fs::path>{fs::path(CALOT_SOURCE_DIR) / "assets"});
    window->resize(1366, 768);
    window->show();
    EXPECT_TRUE(window->openDatabase(file("c.db")));
    return window;
  }
  void fillWithMany() const {
    fs::remove(root_ / "c.db");
    analytics::CohortDatabase database(file("c.db").toStdString(), Access::create);
    for (int i = 0; i < 12; ++i) {
      analytics::AttemptRecord attempt = test::attemptNumber(i);
      attempt.participant = "P1";
      if (i >= 10) {
        attempt.scene = "clip-and-cut";
        attempt.comparabilityKey = "clip-and-cut/1 device=- calibration=- simulation=1 results=1 mode=practice";
      }
      database.storeAttempt(attempt, {test::pathLength("left", 0.3 + 0.5 / (i + 1) + 0.01 * (i % 3))});
    }
  }
  static std::string bytesOf(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::ostringstream all;
    all << in.rdbuf();
    return all.str();
  }
};

TEST_F(Instructor, ReadsAnAttemptInWordsFirst) {
  const auto window = opened();
  AttemptPage& page = openAttempt(*window);
  const auto text = [&](const char* name) { return child<QLabel>(page, name)->text(); };
  expectHolds(text("summary-verdict").toStdString(), {"stopped"});
  auto& bars = *child<PlotView>(page, "figure-bars");
  ASSERT_FALSE(bars.marks().empty());
  EXPECT_TRUE(std::ranges::any_of(bars.marks(),
                                  [](const analytics::DrawnMark& mark) { return mark.key == "path-length left"; }));
  EXPECT_LT(child<QLabel>(page, "summary-verdict")->mapTo(window.get(), QPoint()).y(),
            child<QTreeView>(page, "attempt-checkpoints")->mapTo(window.get(), QPoint()).y());
  EXPECT_FALSE(child<QLabel>(page, "summary-critical-view")->isVisible()) << "this scene has none";
}

TEST_F(Instructor, FoldsCheckpointsByFamilyAndSortsThem) {
  const auto window = opened();
  AttemptPage& page = openAttempt(*window);
  QTreeView& tree = *child<QTreeView>(page, "attempt-checkpoints");
  auto& model = dynamic_cast<FamilyTreeModel&>(*tree.model());
  ASSERT_GT(model.rowCount(), 2);
  EXPECT_GT(model.leftOut(), 0) << "the scene has no fat, no vessels and no procedure";
  int shown = 0;
  for (int f = 0; f < model.rowCount(); ++f) {
    const QModelIndex family = model.index(f, 0);
    EXPECT_FALSE(tree.isExpanded(family)) << "the figures that count stand above";
    shown += model.rowCount(family);
    for (int row = 0; row < model.rowCount(family); ++row) {
      analytics::CheckpointValue cell;
      cell.availability = analytics::Availability::notApplicable;
      const QString text = model.index(row, CheckpointTableModel::valueColumn, family).data().toString();
      cell.reason = text.section(": ", 1).toStdString();  // "none: " and the reason
      EXPECT_FALSE(analytics::sceneLacks(cell)) << cell.reason;
    }
  }
  EXPECT_EQ(shown + model.leftOut(), page.figures().figures().rowCount());
  tree.setFocus();
  tree.setCurrentIndex(model.index(0, 0));
  QTest::keyClick(&tree, Qt::Key_Right);
  EXPECT_TRUE(tree.isExpanded(model.index(0, 0))) << "unfolds by key";
  for (const Qt::SortOrder order : {Qt::AscendingOrder, Qt::DescendingOrder}) {
    tree.sortByColumn(CheckpointTableModel::valueColumn, order);
    const QModelIndex family = model.index(1, 0);
    double before = order == Qt::AscendingOrder ? -1e300 : 1e300;
    for (int row = 0; row < model.rowCount(family); ++row) {
      const auto& value = page.figures().figures().value(model.sourceRow(model.index(row, 0, family)));
      if (!value.value) continue;
      const double now = *value.value * (analytics::definitionOf(value)->displayFactor);
      EXPECT_TRUE(order == Qt::AscendingOrder ? before <= now : now <= before);
      before = now;
    }
  }
}

TEST_F(Instructor, FindsEventsInGroupsThatSayWhich) {
  test::startApplication();
  QStandardItemModel model;
  listEvents(model,
             {{1.0, "clip set", "cystic duct: clip set (right hand)"},
              {2.0, "clip lost", "clip lost (right hand)", true, Severity::major},
              {3.0, "clip set", "cystic artery: clip set (right hand)"},
              {4.0, "clip lost", "clip lost (left hand)", true, Severity::major}},
             {{Severity::critical, 1, 5.0, "cystic duct left open"}, {Severity::major, 2, 4.0, "clip lost"}});
  ASSERT_EQ(model.rowCount(), 3);
  EXPECT_EQ(model.index(0, 0).data().toString(), QString::fromUtf8("▲ Critical: cystic duct left open"));
  const QModelIndex lost = model.index(1, 0);
  EXPECT_EQ(lost.data().toString(), QString::fromUtf8("▲ Major: clip lost, 2 times"));
  EXPECT_EQ(lost.data(eventSecondsRole).toDouble(), 4.0) << "its worst moment";
  EXPECT_EQ(model.rowCount(lost), 2);
  EXPECT_EQ(model.index(0, 0, lost).data().toString(), "clip lost (right hand)");
  const QModelIndex set = model.index(2, 0);
  EXPECT_EQ(set.data().toString(), "Clip set (2)");
  EXPECT_EQ(model.index(1, 0, set).data().toString(), "cystic artery: clip set (right hand)");
  EXPECT_EQ(model.index(1, 0, set).data(eventSecondsRole).toDouble(), 3.0);
}

TEST_F(Instructor, WritesASheetWithPicturesOffTheWindowsThread) {
  const auto window = opened();
  AttemptPage& page = openAttempt(*window);
  ASSERT_FALSE(page.figures().worstMoments().empty());
  QSignalSpy written(&page, &AttemptPage::sheetWritten);
  double most = 0.0;
  QObject::connect(&page.work(), &LongWork::progressed, &page, [&](double share) { most = std::max(most, share); });
  page.writeSheet(root_ / "page.pdf");
  EXPECT_TRUE(page.work().busy()) << "returns at once";
  EXPECT_TRUE(child<QPushButton>(page, "work-cancel")->isVisible());
  ASSERT_TRUE(written.wait(patience)) << child<QLabel>(*window, "problem")->text().toStdString();
  EXPECT_GE(most, 0.9);
  const std::string pdf = bytesOf(root_ / "page.pdf");
  EXPECT_EQ(pdf.rfind("%PDF-", 0), 0U);
  EXPECT_NE(pdf.find("/Subtype /Image"), std::string::npos) << "with a picture";
}

TEST_F(Instructor, BreaksOffLongWorkAndSeesWhatIsLeft) {
  test::startApplication();
  LongWork work;
  QThread* const windows = QThread::currentThread();
  std::atomic<bool> elsewhere = false, ended = false;
  QSignalSpy cancelled(&work, &LongWork::cancelled), done(&work, &LongWork::done);
  work.start([&](LongWork::Control& control) {
    elsewhere = QThread::currentThread() != windows;
    try {
      for (int i = 0;; ++i) {
        control.progress(std::min(0.9, 0.1 * i), "going on");
        QThread::msleep(5);
      }
    } catch (const LongWork::Broken&) {
      ended = true;
      throw;
    }
    return QString();
  });
  ASSERT_TRUE(QTest::qWaitFor([&] { return work.share() > 0.5; }, patience));
  EXPECT_GT(work.secondsLeft(), 0.0);
  work.cancel();
  EXPECT_EQ(cancelled.count(), 1);
  EXPECT_FALSE(work.busy());
  EXPECT_TRUE(QTest::qWaitFor([&] { return ended.load(); }, patience));
  EXPECT_TRUE(elsewhere);
  EXPECT_EQ(done.count(), 0);
  EXPECT_EQ(leftText(12.4), "about 12 s left");
  EXPECT_EQ(leftText(130.0), "about 2 min left");
  EXPECT_EQ(leftText(-1.0), "");
}

TEST_F(Instructor, ChoosesColumnsAndSeveralAttemptsAtOnce) {
  fillWithMany();
  {
    const auto window = opened();
    QTableView& table = *child<QTableView>(*window, "attempts");
    QMenu* const menu = child<QPushButton>(*window, "columns")->menu();
    emit menu->aboutToShow();
    for (QAction* action : menu->actions()) {
      if (action->text() == "Mode") action->toggle();
    }
    EXPECT_TRUE(table.isColumnHidden(AttemptTableModel::modeColumn));
    table.selectRow(0);
    table.selectionModel()->select(QItemSelection(table.model()->index(0, 0), table.model()->index(2, 0)),
                                   QItemSelectionModel::Select | QItemSelectionModel::Rows);
    EXPECT_EQ(window->findChild<AttemptsPage*>()->selectedAll().size(), 3U);
    EXPECT_TRUE(child<QLabel>(*window, "count")->text().contains("3 selected"));
    QSignalSpy shown(&*window, &DashboardWindow::documentShown);
    window->excludeOrInclude("the light failed", "R1");
    ASSERT_TRUE(shown.wait(test::patience));
    const auto excluded = [&] {
      int count = 0;
      for (const analytics::AttemptRow& a :
           analytics::CohortDatabase(file("c.db").toStdString(), Access::read).listAttempts())
        count += a.excluded ? 1 : 0;
      return count;
    };
    EXPECT_EQ(excluded(), 3);
    window->findChild<QUndoStack*>()->undo();
    ASSERT_TRUE(shown.wait(test::patience));
    EXPECT_EQ(excluded(), 0) << "in one go";
  }
  EXPECT_TRUE(child<QTableView>(*opened(), "attempts")->isColumnHidden(AttemptTableModel::modeColumn)) << "remembered";
}

TEST_F(Instructor, OpensAnAttemptByItsDotOnAxesThatStartWhereDataDo) {
  fillWithMany();
  const auto window = opened();
  showPage(*window, 3);
  auto& chart = *window->findChild<PlotView*>("comparison-chart");
  ASSERT_TRUE(QTest::qWaitFor([&] { return !chart.marks().empty(); }, patience));
  double top = 1e300, bottom = -1e300;
  for (const analytics::DrawnMark& mark : chart.marks()) {
    top = std::min(top, mark.y);
    bottom = std::max(bottom, mark.y);
  }
  const analytics::Drawing& drawing = chart.drawing();
  const analytics::PlotFrame frame{drawing.width, drawing.height, true};
  EXPECT_LT(frame.bottom() - bottom, 0.1 * (bottom - top));
  EXPECT_LT(top - frame.top(), 0.1 * (bottom - top));
  // By key, then by mouse.
  QSignalSpy chosen(&chart, &PlotView::attemptChosen);
  chart.setFocus();
  QTest::keyClick(&chart, Qt::Key_Right);
  QTest::keyClick(&chart, Qt::Key_Return);
  ASSERT_EQ(chosen.count(), 1);
  EXPECT_EQ(chosen[0][0].toString(), QString::fromStdString(chart.marks()[0].key));
  EXPECT_EQ(window->findChild<QTabWidget*>()->currentIndex(), 1) << "the page Attempt";
  showPage(*window, 3);
  QTest::qWait(200);
  const analytics::DrawnMark dot = chart.marks()[4];
  QTest::mouseClick(&chart, Qt::LeftButton, {}, chart.placeOf(dot).toPoint());
  ASSERT_EQ(chosen.count(), 2);
  EXPECT_EQ(chosen[1][0].toString(), QString::fromStdString(dot.key));
  EXPECT_EQ(analytics::plotScale(std::vector{0.0, 10.0})->low, 0.0) << "nothing lies below zero";
  EXPECT_GT(analytics::plotScale(std::vector{5.0, 5.0})->high, 5.0);
}

TEST_F(Instructor, SeesNoGroupsWhileTheyAreMasked) {
  fillWithMany();
  analytics::drawGroupMask(file("c.db").toStdString(), std::string(64, '0'));
  const auto window = opened();
  showPage(*window, 3);
  const auto& caption = *child<QLabel>(*window, "caption");
  auto& chart = *window->findChild<PlotView*>("comparison-chart");
  ASSERT_TRUE(QTest::qWaitFor([&] { return !chart.marks().empty(); }, patience)) << "by participant or profile";
  child<QComboBox>(*window, "group-by")->setCurrentIndex(static_cast<int>(GroupBy::group));
  EXPECT_TRUE(chart.marks().empty());
  EXPECT_TRUE(caption.text().contains("masked"));
}

TEST_F(Instructor, FollowsATraineeOverTasksWithACurveItsBandAndAGoal) {
  fillWithMany();
  const auto window = opened();
  showPage(*window, 5);
  auto& chart = *window->findChild<PlotView*>("history-chart");
  ASSERT_TRUE(QTest::qWaitFor([&] { return chart.marks().size() == 10; }, patience));
  const auto& shapes = chart.drawing().shapes;
  EXPECT_TRUE(std::any_of(shapes.begin(), shapes.end(), [](const analytics::Shape& shape) {
    const auto* text = std::get_if<analytics::DrawnText>(&shape.form);
    return text != nullptr && text->text == "95 % band of the curve";
  }));
  QTableWidget& tasks = *child<QTableWidget>(*window, "trainee-tasks");
  ASSERT_EQ(tasks.rowCount(), 2);
  EXPECT_EQ(tasks.item(1, 1)->text(), "2");
  expectHolds(child<QLabel>(*window, "trainee-goal")->text().toStdString(), {"norm"});
  emit tasks.itemActivated(tasks.item(1, 0));
  EXPECT_EQ(chart.marks().size(), 2U) << "the other task";
}

TEST_F(Instructor, SeesTwoAttemptsTracesOnOnePlot) {
  const auto window = opened();
  showPage(*window, 6);
  PairPage& page = *window->findChild<PairPage*>();
  page.chooseTwo();
  child<QComboBox>(page, "left-attempt")->setCurrentIndex(1);
  child<QComboBox>(page, "right-attempt")->setCurrentIndex(2);
  ASSERT_TRUE(
      QTest::qWaitFor([&] { return page.settled() && child<QSlider>(page, "pair-scrub")->isEnabled(); }, patience));
  auto& traces = *child<TraceChart>(page, "pair-traces");
  ASSERT_TRUE(
      QTest::qWaitFor([&] { return traces.values()[0].size() > 100 && traces.values()[1].size() > 100; }, patience));
  child<QComboBox>(page, "pair-trace")->setCurrentIndex(2);
  for (const auto& line : traces.values()) EXPECT_GT(*std::max_element(line.begin(), line.end()), 0.0);
  EXPECT_NE(traces.values()[0], traces.values()[1]);
}

}  // namespace
}  // namespace calot::gui
