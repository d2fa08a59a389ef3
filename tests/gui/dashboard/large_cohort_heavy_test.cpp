// SPDX-License-Identifier: GPL-3.0-or-later
// Nothing that a person does with a cohort of 10,000 attempts keeps the window from answering for 50 ms. Measured where
// CALOT_HEAVY is set.
#include <gtest/gtest.h>
#include <QApplication>
#include <QCheckBox>
#include <QComboBox>
#include <QHeaderView>
#include <QLineEdit>
#include <QPushButton>
#include <QSignalSpy>
#include <QTableView>
#include <QTabWidget>
#include <QTemporaryDir>
#include <QTest>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <optional>

#include "apps/calot-dashboard/assess_program.h"
#include "gui/dashboard/attempt_page.h"
#include "gui/dashboard/attempts_page.h"
#include "gui/dashboard/dashboard_window.h"
#include "gui/dashboard/figures_page.h"
#include "gui/dashboard/study_page.h"
#include "tests/gui/dashboard/support/cohort.h"
#include "tests/gui/dashboard/support/loop_watch.h"
#include "tests/gui/dashboard/support/recorded.h"

namespace calot::gui {
namespace {

namespace fs = std::filesystem;

constexpr double longestTurn = 50.0;  // ms
constexpr int endsWithin = 600000;    // ms for anything to end

class LargeCohortHeavy : public test::Waiting {
 protected:
  void SetUp() override {
    Waiting::SetUp();
    if (IsSkipped()) return;
    static QTemporaryDir made;
    const fs::path large = fs::path(made.path().toStdString()) / "c.db";
    if (!fs::exists(large)) {
      // One that can be verified, and thousands.
      const fs::path recording = large.parent_path() / "one.h5";
      test::makeLargeCohort(large.string(), 10000);
      test::recordPerformer(recording, 3.0, 3);
      const std::string command =
          std::string(CALOT_PROGRAM) + " assess " + recording.string() + " --cohort " + large.string() + " > /dev/null";
      ASSERT_EQ(std::system(command.c_str()), 0);
    }
    for (const char* name : {"c.db", "one.h5"}) fs::copy_file(large.parent_path() / name, root_ / name);
    window_.emplace(apps::assessProgram());
    window_->resize(1366, 768);
    window_->show();
    open();
  }
  void TearDown() override { window_.reset(); }

  [[nodiscard]] QString database() const { return QString::fromStdString((root_ / "c.db").string()); }
  void open() {
    QSignalSpy shown(&*window_, &DashboardWindow::documentShown);
    window_->openLater(database());
    ASSERT_TRUE(shown.count() > 0 || shown.wait(endsWithin));
    QTest::qWait(500);
  }
  template <class T>
  T* part(const char* name) {
    T* const found = window_->findChild<T*>(name);
    EXPECT_NE(found, nullptr) << name;
    return found;
  }
  /// @param number from 1
  void showPage(int number) {
    window_->findChild<QTabWidget*>()->setCurrentIndex(number - 1);
    QTest::qWait(50);
  }
  void wait(const std::function<bool()>& condition) {
    EXPECT_TRUE(QTest::qWaitFor(condition, endsWithin));
    QTest::qWait(200);
  }
  /// What a person does at one place, one thing after the other.
  void each(std::initializer_list<std::function<void()>> actions) {
    for (const auto& action : actions) {
      action();
      QTest::qWait(100);
    }
  }

  QTemporaryDir folder_;
  fs::path root_ = folder_.path().toStdString();
  std::optional<DashboardWindow> window_;
};

TEST_F(LargeCohortHeavy, AttemptsAreOpenedFilteredSortedAndSelected) {
  test::LoopWatch watch;
  open();
  watch.judge("opened", longestTurn);
  window_->reload();
  QSignalSpy shown(&*window_, &DashboardWindow::documentShown);
  ASSERT_TRUE(shown.wait(endsWithin));
  QTest::qWait(300);
  watch.judge("read again", longestTurn);
  auto* search = part<QLineEdit>("search");
  for (const QChar letter : QString("P1012 2014")) {
    QTest::keyClick(search, letter.toLatin1());
    QTest::qWait(30);
  }
  wait([] { return true; });
  watch.judge("searched, letter by letter", longestTurn);
  search->clear();
  QTest::qWait(300);
  watch.judge("search cleared", longestTurn);
  auto* verdict = part<QComboBox>("verdict");
  auto* operators = part<QComboBox>("operators");
  each({[&] { verdict->setCurrentIndex(1); }, [&] { verdict->setCurrentIndex(2); },
        [&] { verdict->setCurrentIndex(0); }, [&] { operators->setCurrentIndex(1); },
        [&] { operators->setCurrentIndex(2); }, [&] { operators->setCurrentIndex(0); }});
  watch.judge("filtered", longestTurn);
  auto* table = part<QTableView>("attempts");
  for (int column = 0; column < AttemptTableModel::columnTotal; ++column) {
    for (const Qt::SortOrder order : {Qt::AscendingOrder, Qt::DescendingOrder}) {
      table->sortByColumn(column, order);
      QTest::qWait(50);
    }
    watch.judge("sorted by " + table->model()->headerData(column, Qt::Horizontal).toString().toStdString(),
                longestTurn);
  }
  for (int i = 0; i < 20; ++i) {
    QTest::keyClick(table, Qt::Key_Down);
    QTest::qWait(20);
  }
  watch.judge("gone down the table", longestTurn);
  table->selectAll();
  QTest::qWait(300);
  watch.judge("all selected", longestTurn);
}

TEST_F(LargeCohortHeavy, EveryPageIsOpened) {
  test::LoopWatch watch;
  for (int number = 1; number <= window_->findChild<QTabWidget*>()->count(); ++number) {
    showPage(number);
    if (number == 3) wait([&] { return window_->findChild<ComparePage*>()->ready(); });
    if (number == 5) wait([&] { return window_->findChild<TraineePage*>()->ready(); });
    wait([&] { return !window_->findChild<StudyPage*>()->busy(); });
    watch.judge("page " + window_->findChild<QTabWidget*>()->tabText(number - 1).toStdString(), longestTurn);
  }
}

TEST_F(LargeCohortHeavy, FiguresAreComparedAndTraineesLookedAt) {
  showPage(3);
  wait([&] { return window_->findChild<ComparePage*>()->ready(); });
  showPage(5);
  wait([&] { return window_->findChild<TraineePage*>()->ready(); });
  test::LoopWatch watch;
  showPage(3);
  auto* figure = part<QComboBox>("figure");
  auto* by = part<QComboBox>("group-by");
  each({[&] { figure->setCurrentIndex(5); }, [&] { figure->setCurrentIndex(20); }});
  watch.judge("another figure compared", longestTurn);
  each({[&] { by->setCurrentIndex(0); }, [&] { by->setCurrentIndex(1); }, [&] { by->setCurrentIndex(2); }});
  watch.judge("compared by another group", longestTurn);
  showPage(5);
  auto* trainee = part<QComboBox>("trainee");
  auto* history = part<QComboBox>("trainee-figure");
  each({[&] { trainee->setCurrentIndex(7); }, [&] { trainee->setCurrentIndex(150); }});
  watch.judge("another trainee", longestTurn);
  each({[&] { history->setCurrentIndex(3); }, [&] { history->setCurrentIndex(20); }});
  watch.judge("another figure of a trainee", longestTurn);
}

TEST_F(LargeCohortHeavy, AStudyIsComputedBrokenOffAndExported) {
  StudyPage& study = *window_->findChild<StudyPage*>();
  auto* practice = window_->findChild<QCheckBox*>("study-practice");
  test::LoopWatch watch;
  showPage(4);
  wait([&] { return !study.busy(); });
  ASSERT_TRUE(study.ready());
  watch.judge("study computed", longestTurn);
  auto* row = part<QComboBox>("study-row");
  each({[&] { row->setCurrentIndex(1); }, [&] { row->setCurrentIndex(12); }});
  watch.judge("rows of the study", longestTurn);
  auto* rule = part<QComboBox>("study-rule");
  rule->setCurrentIndex(1);
  wait([&] { return !study.busy(); });
  watch.judge("study of means computed", longestTurn);
  study.write(folder_.filePath("csv"), false);
  wait([&] { return !study.busy(); });
  study.write(folder_.filePath("study.html"), true);
  wait([&] { return !study.busy(); });
  EXPECT_TRUE(fs::exists(root_ / "csv" / "study.csv") && fs::exists(root_ / "study.html"));
  watch.judge("study exported", longestTurn);
  practice->toggle();
  practice->toggle();
  study.findChild<QPushButton*>("work-cancel")->click();
  QTest::qWait(1000);
  EXPECT_FALSE(study.ready());
  watch.judge("study broken off", longestTurn);
}

TEST_F(LargeCohortHeavy, ARecordingIsVerifiedAndAttemptsAreExcluded) {
  auto* table = part<QTableView>("attempts");
  part<QLineEdit>("search")->setText("skilled");
  QTest::qWait(300);
  ASSERT_EQ(table->model()->rowCount(), 1) << "the one that a performer recorded";
  table->selectRow(0);
  QTest::qWait(100);
  test::LoopWatch watch;
  window_->verifySelected();
  wait([&] { return !window_->imports().busy(); });
  QTest::qWait(1000);
  watch.judge("a recording verified", longestTurn);
  part<QLineEdit>("search")->setText("P1012");
  QTest::qWait(300);
  ASSERT_EQ(table->model()->rowCount(), 50);
  table->selectAll();
  QTest::qWait(300);
  watch.begin();
  QSignalSpy shown(&*window_, &DashboardWindow::documentShown);
  window_->excludeOrInclude("a reason", "A. Nalyst");
  ASSERT_TRUE(shown.wait(endsWithin));
  QTest::qWait(1000);
  watch.judge("50 attempts excluded", longestTurn);
}

}  // namespace
}  // namespace calot::gui
