// SPDX-License-Identifier: GPL-3.0-or-later
// Ten tasks of an instructor by real keys: each reaches its goal with the presses that
// docs/reference/instructor-tasks.md states, and no more than half of the seconds that it took before.
#include <gtest/gtest.h>
#include <cmath>
#include <QApplication>
#include <QComboBox>
#include <QDialog>
#include <QDir>
#include <QKeyCombination>
#include <QLabel>
#include <QLineEdit>
#include <QSignalSpy>
#include <QStatusBar>
#include <QTableView>
#include <QTableWidget>
#include <QTest>
#include <QTimer>

#include <fstream>
#include <functional>
#include <map>
#include <sstream>

#include "analytics/assessment/norm.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/report/course_tables.h"
#include "apps/calot-dashboard/assess_program.h"
#include "gui/attempt/replay_player.h"
#include "gui/dashboard/attempts_page.h"
#include "gui/dashboard/course_page.h"
#include "gui/dashboard/dashboard_window.h"
#include "gui/dashboard/dialogs.h"
#include "gui/dashboard/figure_panel.h"
#include "gui/dashboard/norm_dialog.h"
#include "gui/dashboard/rating_queue.h"
#include "gui/dashboard/ratings_page.h"
#include "gui/dashboard/recording_view.h"
#include "gui/dashboard/study_page.h"
#include "tests/gui/dashboard/support/assessed.h"
#include "tests/gui/dashboard/support/recorded.h"

namespace calot::gui {
namespace {

namespace fs = std::filesystem;
using Access = analytics::CohortDatabase::Access;
using test::patience;

/// A way to do a task, in operators of the keystroke-level model.
struct Way {
  int presses = 0;  ///< keys and clicks
  double seconds = 0.0;
  Way() = default;
  explicit Way(const std::string& operators) {
    static const std::map<char, double> costs{{'K', 0.2}, {'P', 1.1}, {'B', 0.1}, {'H', 0.4}, {'M', 1.35}};
    std::map<char, int> count;
    std::istringstream words(operators);
    for (std::string word; words >> word;) {
      const int times = word.size() > 1 ? std::stoi(word) : 1;
      count[word.back()] += times;
      seconds += times * costs.at(word.back());
    }
    presses = count['K'] + count['B'] / 2;
  }
};

struct Row {
  std::string task;
  Way before, after;
};

/// The page's table: number, task, and for both ways operators, presses and seconds; the share.
std::vector<Row> rowsOfThePage() {
  std::ifstream in(fs::path(CALOT_SOURCE_DIR) / "docs" / "reference" / "instructor-tasks.md");
  std::vector<Row> rows;
  for (std::string line; std::getline(in, line);) {
    std::vector<std::string> cells;
    std::istringstream parts(line);
    for (std::string cell; std::getline(parts, cell, '|');) cells.push_back(cell);
    if (cells.size() < 10 || std::atoi(cells[1].c_str()) == 0) continue;
    Row row{QString::fromStdString(cells[2]).trimmed().toStdString(), Way(cells[3]), Way(cells[6])};
    for (const auto& [way, first] : {std::pair{&row.before, 4U}, std::pair{&row.after, 7U}}) {
      EXPECT_EQ(std::stoi(cells[first]), way->presses) << line;
      EXPECT_NEAR(std::stod(cells[first + 1]), way->seconds, 0.051) << line;
    }
    EXPECT_NEAR(std::stod(cells[9]), 100.0 * row.after.seconds / row.before.seconds, 0.51) << line;
    rows.push_back(row);
  }
  return rows;
}

TEST(TenTasksPage, StatesWaysThatTakeAtMostHalfOfWhatTheyTook) {
  const std::vector<Row> rows = rowsOfThePage();
  EXPECT_EQ(rows.size(), 10U);
  for (const Row& row : rows) {
    EXPECT_LE(row.after.seconds, 0.5 * row.before.seconds) << row.task;
    EXPECT_LE(2 * row.after.presses, row.before.presses) << row.task;
  }
}

/// A person's hands at the keyboard: keys go to where the focus is, and each is counted.
class Hands {
 public:
  void press(QKeyCombination keys) {
    for (const auto modifier : {Qt::ControlModifier, Qt::ShiftModifier, Qt::AltModifier})
      presses_ += keys.keyboardModifiers().testFlag(modifier) ? 1 : 0;
    ++presses_;
    QTest::keyClick(target(), keys.key(), keys.keyboardModifiers());
  }
  void type(const char* text) {
    for (const char* letter = text; *letter != '\0'; ++letter) {
      ++presses_;
      QTest::keyClick(target(), *letter);
    }
  }
  /// Presses keys that open a dialog, and Enter in it. @param before Enter: what a person would wait for
  void pressAndAccept(QKeyCombination keys, const std::function<void(QWidget&)>& before = {}) {
    QTimer timer;
    QObject::connect(&timer, &QTimer::timeout, [&] {
      QWidget* const dialog = QApplication::activeModalWidget();
      if (dialog == nullptr || !dialog->isActiveWindow()) return;
      timer.stop();
      if (before) before(*dialog);
      press(Qt::Key_Return);
    });
    timer.start(20);
    press(keys);
    EXPECT_TRUE(QTest::qWaitFor([&] { return !timer.isActive(); }, patience)) << "no dialog came";
  }
  [[nodiscard]] int presses() const { return presses_; }

 private:
  static QWidget* target() {
    QWidget* const focus = QApplication::focusWidget();
    return focus != nullptr ? focus : QApplication::activeWindow();
  }
  int presses_ = 0;
};

/// Experts, interns and novices have the figures of a real recording, with paths longer by a factor; a norm sets
/// experts apart, and a course wants it of the interns. The newest attempts are the two real ones.
class TenTasks : public test::AssessedCohort {
 protected:
  static constexpr int experts = 5, interns = 3, novices = 5;

  void SetUp() override {
    test::AssessedCohort::SetUp();
    settings::setPerson("R1");
    drafts::keepRater("R1");
    drafts::keepForm("goals");
    qputenv("CUPS_SERVER", "/nowhere");  // a printer of this machine prints nothing
    QDir::setCurrent(folder_.path());
    addPeople();
    addCourse();
    window_ = std::make_unique<DashboardWindow>(apps::assessProgram(),
                                                std::vector<fs::path>{fs::path(CALOT_SOURCE_DIR) / "assets"});
    window_->resize(1366, 768);
    window_->show();
    window_->activateWindow();
    ASSERT_TRUE(QTest::qWaitForWindowActive(window_.get()));
    ASSERT_TRUE(window_->openDatabase(file("c.db")));
    ASSERT_TRUE(window_->findChild<AttemptsPage*>()->selected()->synthetic) << "a real one is the newest";
  }
  void TearDown() override {
    settings::setCourse({});
    drafts::keepRater({});
    drafts::keepForm({});
    QDir::setCurrent(QDir::tempPath());
  }
  [[nodiscard]] analytics::CohortDatabase cohort(Access access = Access::read) const {
    return analytics::CohortDatabase(file("c.db").toStdString(), access);
  }
  void addPeople() const {
    analytics::CohortDatabase database = cohort(Access::write);
    // The performer was stopped by the clock; what a grade takes was brought to its end.
    for (analytics::AttemptRecord whole : database.listAttempts()) {
      whole.outcome = recorder::Outcome::completed;
      database.storeAttempt(whole, database.values(whole.uuid));
    }
    const analytics::AttemptRow real = database.listAttempts().front();
    const std::vector<analytics::CheckpointValue> values = database.values(real.uuid);
    int number = 0;
    const auto add = [&](const std::string& who, const std::string& group, double factor) {
      analytics::AttemptRecord attempt = real;
      attempt.uuid = "00000000-0000-4000-8000-0000000000" + std::to_string(10 + number);
      attempt.operatorKind = recorder::OperatorKind::human;
      attempt.profile.clear();
      attempt.profileVersion.clear();
      attempt.synthetic = false;
      attempt.participant = who;
      attempt.startUtc = "2026-03-01T10:" + std::to_string(10 + number++) + ":00Z";
      attempt.fileName = who + ".h5";
      std::vector<analytics::CheckpointValue> worse = values;
      for (analytics::CheckpointValue& value : worse) {
        if (value.value && value.name == "path-length") *value.value *= factor;
      }
      database.storeAttempt(attempt, worse);
      analytics::ParticipantChange change;
      change.group = group;
      database.setParticipant(who, change);
    };
    for (int i = 0; i < experts; ++i) add("E" + std::to_string(i), "expert", 1.0 + 0.02 * i);
    for (int i = 0; i < novices; ++i) add("N" + std::to_string(i), "novice", 1.7 + 0.02 * i);
    add("Ariane", "intern", 1.8);
    for (int i = 1; i < interns; ++i) add("I" + std::to_string(i), "intern", 1.5 + 0.1 * i);
    analytics::NormRequest request;
    request.name = "clinic";
    request.by = "R1";
    request.who.groups = {"expert", "novice"};
    request.who.better = "expert";
    request.who.includePractice = true;
    database.storeNorm(analytics::makeNorm(database.listAttempts(), database.allValues(), {}, request, "c.db"));
  }
  void addCourse() const {
    std::ofstream(root_ / "course.json")
        << R"({"format": "calot-course", "formatVersion": 1, "name": "first", "title": "First year",
        "groups": ["intern"], "tasks": [{"scene": ")"
        << cohort().listAttempts().front().scene
        << R"(", "title": "Touch", "goal": "Touch.", "criterion": {"norm": "clinic", "passes": 2, "dueDays": 1}}]})";
    settings::setCourse(file("course.json"));
  }
  template <class T>
  [[nodiscard]] T& part() const {
    return *window_->findChild<T*>();
  }
  [[nodiscard]] bool waitFor(const std::function<bool()>& condition) const {
    return QTest::qWaitFor(condition, patience);
  }
  [[nodiscard]] std::string groupOf(const std::string& who) const {
    const auto people = cohort().participants();
    return std::ranges::find(people, who, &analytics::Participant::pseudonym)->group;
  }
  void changeGroupOfAriane() {
    QSignalSpy shown(window_.get(), &DashboardWindow::documentShown);
    hands_.press(Qt::CTRL | Qt::Key_F);
    hands_.type("ariane");
    hands_.press(Qt::CTRL | Qt::Key_G);
    hands_.type("expert");
    hands_.press(Qt::Key_Return);
    ASSERT_TRUE(shown.wait(patience));
  }
  /// @param number of the task in the table
  void expectPresses(std::size_t number, int before = 0) const {
    const std::vector<Row> rows = rowsOfThePage();
    ASSERT_GE(rows.size(), number);
    EXPECT_EQ(hands_.presses() - before, rows[number - 1].after.presses) << rows[number - 1].task;
  }

  std::unique_ptr<DashboardWindow> window_;
  Hands hands_;
};

TEST_F(TenTasks, GradeOne) {
  QSignalSpy written(&part<AttemptPage>(), &AttemptPage::sheetWritten);
  hands_.pressAndAccept(Qt::CTRL | Qt::Key_S);
  ASSERT_TRUE(written.count() > 0 || written.wait(patience))
      << child<QLabel>(*window_, "problem")->text().toStdString();
  expectPresses(1);
  EXPECT_NE(part<FigurePanel>().grade(), nullptr);
  const QStringList sheets = QDir(folder_.path()).entryList({"sheet-*.pdf"});
  ASSERT_EQ(sheets.size(), 1);
  std::ifstream in(file(qPrintable(sheets[0])).toStdString(), std::ios::binary);
  const std::string pdf((std::istreambuf_iterator<char>(in)), {});
  EXPECT_NE(pdf.find("/Subtype /Image"), std::string::npos) << "moments were waited for";
}

TEST_F(TenTasks, FindTheWorstMoment) {
  QSignalSpy chosen(&part<FigurePanel>(), &FigurePanel::timeChosen);
  hands_.press(Qt::Key_Return);
  hands_.press(Qt::Key_W);
  ASSERT_TRUE(chosen.count() > 0 || chosen.wait(patience)) << "when the recording was read";
  expectPresses(2);
  const auto& page = part<AttemptPage>();
  ASSERT_TRUE(waitFor([&] { return page.settled(); }));
  const double time = chosen[0][0].toDouble();
  EXPECT_NEAR(part<AttemptPage>().replay().position().time, time, 0.011);
  const CheckpointTableModel& figures = part<FigurePanel>().figures();
  int that = -1;
  for (int row = 0; row < figures.rowCount(); ++row) {
    const analytics::FigureMoments* const found = figures.moments(row);
    if (found == nullptr || found->moments.empty()) continue;
    if (std::abs(std::max(0.0, worstOf(found->moments).begin - MomentCycle::leadIn) - time) < 1e-9) that = row;
  }
  const auto& errors = part<FigurePanel>().errors();
  if (!errors.empty()) {
    EXPECT_EQ(time, errors.front().time) << "the gravest error";
  }
  EXPECT_TRUE(!errors.empty() || that >= 0) << "it is the worst one of a figure";
}

/// As far as the system's dialog, which Ctrl+P opens with this document.
TEST_F(TenTasks, Print) {
  hands_.press(Qt::Key_Return);
  bool made = false;
  EXPECT_TRUE(part<AttemptPage>().makeDocument([&](const auto&) { made = true; }));
  EXPECT_TRUE(waitFor([&] { return made; }));
}

TEST_F(TenTasks, CompareTwoGroups) {
  QSignalSpy shown(&part<StudyPage>(), &StudyPage::studyShown);
  hands_.press(Qt::CTRL | Qt::Key_4);
  ASSERT_TRUE(shown.wait(patience));
  expectPresses(4);
  EXPECT_EQ(child<QComboBox>(*window_, "study-first")->currentText(), "expert");
  EXPECT_EQ(child<QComboBox>(*window_, "study-second")->currentText(), "novice") << "of whom there are more";
  EXPECT_EQ(child<QComboBox>(*window_, "study-first")->count(), 3);
  EXPECT_TRUE(part<StudyPage>().makeDocument([](const auto&) {}));
}

TEST_F(TenTasks, MakeANorm) {
  hands_.pressAndAccept(Qt::CTRL | Qt::Key_M, [&](QWidget& dialog) {
    ASSERT_TRUE(waitFor([&] { return static_cast<NormDialog&>(dialog).settled(); }));
    auto* const closes = new QTimer(&dialog);
    QObject::connect(closes, &QTimer::timeout, &dialog, [&] {
      if (cohort().norms().size() > 1) dialog.close();
    });
    closes->start(50);
  });
  expectPresses(5);
  const std::vector<analytics::Norm> norms = cohort().norms();
  ASSERT_EQ(norms.size(), 2U);
  const auto made = std::ranges::find(norms, cohort().listAttempts().front().scene, &analytics::Norm::name);
  ASSERT_NE(made, norms.end()) << "called after the task";
  EXPECT_EQ(made->by, "R1");
  EXPECT_EQ(made->members.size(), static_cast<std::size_t>(experts + novices));
}

TEST_F(TenTasks, Rate) {
  const analytics::AttemptRow& chosen = *part<AttemptsPage>().selected();
  const std::string attempt = chosen.uuid;
  const std::uint32_t version = analytics::readRatingForm(CALOT_SOURCE_DIR "/assets/forms/goals.json").version;
  const RatingSubject subject{file("c.db").toStdString(), "goals", version, attempt, "R1", {}};
  drafts::keepFilm(subject);
  // The film was seen: a rating is timed from then on.
  SeenFilm film;
  const double seconds = static_cast<double>(chosen.steps) * chosen.stepSeconds;
  film.setLength(seconds);
  for (double time = 0.0; time < seconds; time += 0.1) film.show(time);
  ASSERT_TRUE(film.suffices());
  drafts::keepSeen(subject, film);
  hands_.press(Qt::CTRL | Qt::Key_7);
  const auto& page = part<RatingPage>();
  ASSERT_TRUE(waitFor([&] { return page.settled(); }));
  ASSERT_TRUE(page.seenFilm().suffices());
  hands_.type("34543");
  hands_.press(Qt::Key_Return);
  expectPresses(6);
  ASSERT_TRUE(waitFor([&] { return cohort().ratings().size() == 1; }));
  const analytics::Rating rating = cohort().ratings().front();
  EXPECT_EQ(rating.attempt, attempt);
  EXPECT_EQ(rating.rater, "R1");
  EXPECT_EQ(rating.answers, (std::map<std::string, int>{{"depth-perception", 3},
                                                        {"bimanual-dexterity", 4},
                                                        {"efficiency", 5},
                                                        {"tissue-handling", 4},
                                                        {"autonomy", 3}}));
}

TEST_F(TenTasks, Import) {
  test::recordPerformer(root_ / "three.h5", 0.5, 7);
  const std::size_t before = cohort().listAttempts().size();
  hands_.press(Qt::CTRL | Qt::SHIFT | Qt::Key_I);
  EXPECT_EQ(window_->imports().total(), 1) << "those that the cohort knows are left out";
  ASSERT_TRUE(waitFor([&] { return cohort().listAttempts().size() > before; }));
  expectPresses(7);
  const auto attempts = cohort().listAttempts();
  EXPECT_NE(std::ranges::find(attempts, "three.h5", &analytics::AttemptRow::fileName), attempts.end());
  QSignalSpy shown(window_.get(), &DashboardWindow::documentShown);
  ASSERT_TRUE(waitFor([&] { return !window_->imports().busy(); }));
  ASSERT_TRUE(shown.count() > 0 || shown.wait(patience));
  hands_.press(Qt::CTRL | Qt::SHIFT | Qt::Key_I);
  EXPECT_FALSE(window_->imports().busy()) << "nothing is new";
  EXPECT_FALSE(window_->statusBar()->currentMessage().isEmpty());
}

TEST_F(TenTasks, EditAGroup) {
  changeGroupOfAriane();
  expectPresses(8);
  EXPECT_EQ(groupOf("Ariane"), "expert");
}

TEST_F(TenTasks, FindWhoIsBehind) {
  hands_.press(Qt::CTRL | Qt::Key_8);
  ASSERT_TRUE(waitFor([&] { return part<CoursePage>().ready(); }));
  expectPresses(9);
  const auto progress = readCourseProgress(file("c.db").toStdString(), root_ / "course.json", false);
  const auto people = analytics::behindFirst(*progress);
  const auto& table = *child<QTableWidget>(*window_, "course-people");
  ASSERT_EQ(table.rowCount(), interns);
  ASSERT_TRUE(analytics::isBehind(*people.front()));
  for (int row = 0; row < interns; ++row)
    EXPECT_EQ(table.item(row, 0)->text().toStdString(), people[static_cast<std::size_t>(row)]->participant);
}

TEST_F(TenTasks, RetractAMistake) {
  changeGroupOfAriane();
  const int before = hands_.presses();
  QSignalSpy shown(window_.get(), &DashboardWindow::documentShown);
  hands_.press(Qt::CTRL | Qt::Key_Z);
  ASSERT_TRUE(shown.wait(patience));
  expectPresses(10, before);
  EXPECT_EQ(groupOf("Ariane"), "intern");
}

TEST_F(TenTasks, TheWorstMomentIsFollowedByTheNext) {
  auto& panel = part<FigurePanel>();
  std::vector<analytics::ErrorLine> errors(2);
  errors[0].time = 3.0;
  errors[1].time = 1.0;
  panel.setTrack({}, errors);
  QSignalSpy chosen(&panel, &FigurePanel::timeChosen);
  for (int i = 0; i < 3; ++i) panel.showWorst();
  ASSERT_EQ(chosen.count(), 3);
  EXPECT_EQ(chosen[0][0].toDouble(), 3.0);
  EXPECT_EQ(chosen[1][0].toDouble(), 1.0);
  EXPECT_EQ(chosen[2][0].toDouble(), 3.0);
}

TEST_F(TenTasks, ASearchOpensWhatItFinds) {
  hands_.press(Qt::CTRL | Qt::Key_F);
  hands_.type("ariane");
  hands_.press(Qt::Key_Return);
  EXPECT_TRUE(part<AttemptPage>().isVisible());
  EXPECT_EQ(part<AttemptsPage>().selected()->participant, "Ariane");
}

}  // namespace
}  // namespace calot::gui
