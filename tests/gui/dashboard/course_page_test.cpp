// SPDX-License-Identifier: GPL-3.0-or-later
// The page Course: who is behind first, what each lacks, and from a person to their attempts.
#include "gui/dashboard/course_page.h"

#include <gtest/gtest.h>
#include <QComboBox>
#include <QLabel>
#include <QTableWidget>
#include <QTabWidget>
#include <QTemporaryDir>
#include <QTest>

#include <fstream>

#include "analytics/assessment/norm.h"
#include "analytics/report/course_tables.h"
#include "apps/calot-dashboard/assess_program.h"
#include "gui/dashboard/attempt_page.h"
#include "gui/dashboard/attempts_page.h"
#include "gui/dashboard/dashboard_window.h"
#include "gui/dashboard/dialogs.h"
#include "tests/gui/dashboard/support/cohort.h"
#include "tests/gui/dashboard/support/recorded.h"
#include "tests/support/message.h"

namespace calot::gui {
namespace {

namespace fs = std::filesystem;
constexpr int coursePatience = 60000;  // ms

/// Experts around 50 s and novices around 90 s make the norm. A1 is proficient at once, M1 has passed once, Z1 failed
/// and is behind.
class CoursePages : public testing::Test {
 protected:
  void SetUp() override {
    test::startApplication();
    settings::setCourse({});
    settings::setCourseSynthetic(false);
    analytics::CohortDatabase cohort(path(), analytics::CohortDatabase::Access::create);
    auto add = [&, number = 0](const std::string& who, const std::string& group, double seconds) mutable {
      analytics::AttemptRecord a = test::attemptNumber(number++);
      a.operatorKind = recorder::OperatorKind::human;
      a.profile.clear();
      a.profileVersion.clear();
      a.synthetic = false;
      a.mode = recorder::Mode::assessment;
      a.participant = who;
      a.comparabilityKey = "touch-liver/1 device=- calibration=- simulation=1 results=1 mode=assessment";
      cohort.storeAttempt(a, {analytics::makeValue(*analytics::findCheckpoint("elapsed-time"), "",
                                                   analytics::Origin::resimulated, seconds),
                              analytics::makeValue(*analytics::findCheckpoint("critical-errors"), "",
                                                   analytics::Origin::resimulated, 0.0)});
      analytics::ParticipantChange change;
      change.group = group;
      cohort.setParticipant(who, change);
    };
    for (int i = 0; i < 6; ++i) {
      add("E" + std::to_string(i), "expert", 48.0 + i);
      add("N" + std::to_string(i), "novice", 88.0 + i);
    }
    analytics::NormRequest request;
    request.name = "clinic";
    request.by = "A. Instructor";
    cohort.storeNorm(analytics::makeNorm(cohort.listAttempts(), cohort.allValues(), {}, request, "c.db"));
    for (const double seconds : {50.0, 50.0}) add("A1", "trainee", seconds);
    add("M1", "trainee", 50.0);
    add("Z1", "trainee", 120.0);
    std::ofstream(course()) << R"({"format": "calot-course", "formatVersion": 1, "name": "first", "title": "First year",
        "groups": ["trainee"], "tasks": [
        {"scene": "touch-liver", "title": "Touch", "goal": "Touch.", "criterion": {"norm": "clinic", "passes": 2}},
        {"scene": "carve-fat", "title": "Carve", "goal": "Carve."}]})";
  }
  /// Due days count from a person's first attempt: all of them are over.
  void addDueDays() const {
    std::ifstream in(course());
    std::string text((std::istreambuf_iterator<char>(in)), {});
    text.replace(text.find("\"passes\": 2"), 11, "\"passes\": 2, \"dueDays\": 1");
    std::ofstream(course(), std::ios::trunc) << text;
  }
  [[nodiscard]] std::string path() const { return folder_.filePath("c.db").toStdString(); }
  [[nodiscard]] std::string course() const { return folder_.filePath("course.json").toStdString(); }
  std::unique_ptr<DashboardWindow> opened() const {
    auto window = std::make_unique<DashboardWindow>(apps::assessProgram(),
                                                    std::vector<fs::path>{fs::path(CALOT_SOURCE_DIR) / "assets"});
    window->resize(1366, 768);
    window->show();
    EXPECT_TRUE(window->openDatabase(QString::fromStdString(path())));
    window->findChild<QTabWidget*>()->setCurrentWidget(window->findChild<CoursePage*>());
    EXPECT_TRUE(QTest::qWaitFor([&] { return window->findChild<CoursePage*>()->ready(); }, coursePatience));
    return window;
  }
  std::unique_ptr<DashboardWindow> openedWithCourse() const {
    auto window = opened();
    CoursePage& page = *window->findChild<CoursePage*>();
    page.openCourse(QString::fromStdString(course()));
    EXPECT_FALSE(page.ready());
    EXPECT_TRUE(QTest::qWaitFor([&] { return page.ready(); }, coursePatience));
    return window;
  }
  static std::string cell(const QTableWidget& table, int row, int column) {
    const QTableWidgetItem* item = table.item(row, column);
    return item == nullptr ? "" : item->text().toStdString();
  }

  QTemporaryDir folder_;
};

TEST_F(CoursePages, ShowsWhoIsBehindFirstInTheWordsOfTheCommand) {
  addDueDays();
  const auto window = openedWithCourse();
  const auto& people = *window->findChild<QTableWidget*>("course-people");
  const auto progress = readCourseProgress(path(), course(), false);
  ASSERT_EQ(people.rowCount(), 3) << window->findChild<QLabel*>("course-summary")->text().toStdString();
  EXPECT_EQ(cell(people, 0, 0), "M1");
  EXPECT_EQ(cell(people, 1, 0), "Z1");
  EXPECT_EQ(cell(people, 2, 0), "A1") << "who is not behind comes last";
  for (int row = 0; row < 3; ++row) {
    const auto& person =
        *std::ranges::find(progress->people, cell(people, row, 0), &analytics::CoursePerson::participant);
    EXPECT_EQ(cell(people, row, 2), analytics::proficientOf(progress->course, person));
    for (int t = 0; t < 2; ++t) {
      const auto at = static_cast<std::size_t>(t);
      EXPECT_EQ(cell(people, row, 3 + t), analytics::standingCell(progress->course.tasks[at], person.tasks[at]));
    }
    EXPECT_EQ(cell(people, row, 5), analytics::nextMissing(person));
  }
  EXPECT_EQ(cell(people, 2, 2), "1 of 1");
  EXPECT_EQ(cell(people, 0, 3), "1/2, behind");
  EXPECT_EQ(cell(people, 2, 5), "");
  EXPECT_TRUE(people.isColumnHidden(1)) << "all are of one group";
}

TEST_F(CoursePages, LeadsFromAPersonToTheirAttempts) {
  const auto window = openedWithCourse();
  auto& people = *window->findChild<QTableWidget*>("course-people");
  auto& attempts = *window->findChild<QTableWidget*>("course-attempts");
  EXPECT_EQ(attempts.rowCount(), 2) << "A1's, who is chosen at first";
  window->activateWindow();
  ASSERT_TRUE(QTest::qWaitForWindowActive(window.get()));
  people.setFocus();
  QTest::keyClick(&people, Qt::Key_Down);
  QTest::keyClick(&people, Qt::Key_Down);
  ASSERT_EQ(attempts.rowCount(), 1) << "Z1's";
  expectHolds(window->findChild<QLabel*>("course-person")->text().toStdString(), {"Z1", "0", "2"});
  attempts.setFocus();
  attempts.setCurrentCell(0, 0);
  QTest::keyClick(&attempts, Qt::Key_Return);
  EXPECT_EQ(window->findChild<QTabWidget*>()->currentWidget(), window->findChild<AttemptPage*>());
  EXPECT_EQ(window->findChild<AttemptsPage*>()->selected()->participant, "Z1");
}

TEST_F(CoursePages, IsPrintedAndRemembered) {
  analytics::ReportDocument printed;
  {
    const auto window = openedWithCourse();
    ASSERT_TRUE(window->findChild<CoursePage*>()->makeDocument([&](const auto& document) { printed = document; }));
  }
  EXPECT_EQ(printed.title, "First year");
  const auto table = std::ranges::find_if(
      printed.parts, [](const auto& part) { return std::holds_alternative<analytics::ReportTable>(part); });
  ASSERT_NE(table, printed.parts.end());
  EXPECT_EQ(std::get<analytics::ReportTable>(*table).rows.size(), 3U);
  const auto window = opened();
  EXPECT_EQ(window->findChild<QTableWidget*>("course-people")->rowCount(), 3) << "the course that was chosen last";
}

TEST_F(CoursePages, SaysWhyACourseCannotBeShown) {
  std::ifstream in(course());
  std::string text((std::istreambuf_iterator<char>(in)), {});
  text.replace(text.find("clinic"), 6, "absent");
  std::ofstream(course(), std::ios::trunc) << text;
  const auto window = openedWithCourse();
  expectHolds(window->findChild<QLabel*>("course-summary")->text().toStdString(), {"absent"});
  EXPECT_EQ(window->findChild<QTableWidget*>("course-people")->rowCount(), 0);
  EXPECT_FALSE(window->findChild<CoursePage*>()->makeDocument([](const auto&) {}));
}

TEST_F(CoursePages, TellsTheTraineeWhatIsMissingNext) {
  const auto window = openedWithCourse();
  auto* const tabs = window->findChild<QTabWidget*>();
  tabs->setCurrentIndex(4);
  auto& trainee = *window->findChild<QComboBox*>("trainee");
  auto& missing = *window->findChild<QLabel*>("trainee-course");
  ASSERT_TRUE(QTest::qWaitFor([&] { return trainee.findText("M1") >= 0; }, coursePatience));
  trainee.setCurrentIndex(trainee.findText("M1"));
  ASSERT_TRUE(QTest::qWaitFor([&] { return missing.isVisible(); }, coursePatience));
  const auto progress = readCourseProgress(path(), course(), false);
  const auto person = std::ranges::find(progress->people, std::string("M1"), &analytics::CoursePerson::participant);
  EXPECT_TRUE(missing.text().contains(QString::fromStdString(analytics::nextMissing(*person))))
      << missing.text().toStdString();
  trainee.setCurrentIndex(trainee.findText("E1"));
  EXPECT_FALSE(missing.isVisible()) << "the course is not assigned to experts";
}

}  // namespace
}  // namespace calot::gui
