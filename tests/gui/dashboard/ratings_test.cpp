// SPDX-License-Identifier: GPL-3.0-or-later
// A rater goes through a queue of films: what was seen, anchors, drafts, the next by key, and what is taken back.
#include <gtest/gtest.h>
#include <QCheckBox>
#include <QComboBox>
#include <QLabel>
#include <QLineEdit>
#include <QListView>
#include <QPushButton>
#include <QRadioButton>
#include <QSignalSpy>
#include <QSlider>
#include <QTest>

#include "analytics/cohort/cohort_database.h"
#include "apps/calot-dashboard/assess_program.h"
#include "gui/dashboard/dashboard_window.h"
#include "gui/dashboard/dialogs.h"
#include "gui/dashboard/rating_form_view.h"
#include "gui/dashboard/rating_queue.h"
#include "gui/dashboard/ratings_page.h"
#include "tests/gui/dashboard/support/assessed.h"
#include "tests/gui/dashboard/support/cohort.h"
#include "tests/gui/dashboard/support/recorded.h"
#include "tests/support/message.h"

namespace calot::gui {
namespace {

namespace fs = std::filesystem;
using Access = analytics::CohortDatabase::Access;
using test::patience;

const fs::path assets = fs::path(CALOT_SOURCE_DIR) / "assets";

TEST(SeenFilm, CountsSecondsThatRanOnce) {
  SeenFilm film;
  film.show(0.5);
  EXPECT_EQ(film.share(), 0.0) << "the length is not known yet";
  film.setLength(9.4);
  for (const double time : {0.01, 0.5, 1.0, 1.01, 0.7}) film.show(time);
  EXPECT_DOUBLE_EQ(film.share(), 0.2) << "two of ten seconds";
  for (double time = 2.005; time <= 7.0; time += 0.5) film.show(time);
  EXPECT_FALSE(film.suffices());
  film.show(9.4);
  EXPECT_TRUE(film.suffices()) << "eight of ten, and the last one is shorter";
  SeenFilm later(film.kept());
  EXPECT_EQ(later.share(), 0.0);
  later.setLength(9.4);
  EXPECT_EQ(later.share(), film.share()) << "as it was kept";
}

TEST(FilmQueue, IsOfTheRatersOwnOrderAndLeavesOutWhatIsExcluded) {
  std::vector<analytics::AttemptRow> attempts;
  for (int i = 0; i < 20; ++i) static_cast<analytics::AttemptRecord&>(attempts.emplace_back()) = test::attemptNumber(i);
  attempts[3].excluded = true;
  attempts[4].leftOut = {{1, "consent", "no consent to research"}};
  attempts[5].simulationVersion = 0;  // imported motion
  const std::vector<std::string> one = filmQueue(attempts, "R1"), two = filmQueue(attempts, "R2");
  EXPECT_EQ(one.size(), 17U);
  EXPECT_NE(one, two);
  EXPECT_EQ(one, filmQueue(attempts, "R1"));
  EXPECT_FALSE(std::ranges::is_sorted(one)) << "the order of attempts shows nothing";
  EXPECT_EQ(filmQueue(attempts, "R1", {attempts[7].uuid, attempts[3].uuid}), std::vector{attempts[7].uuid});
}

TEST(RatingForms, HaveTheWordsOfAnAnchorAtItsPoint) {
  test::startApplication();
  const analytics::RatingForm form = analytics::readRatingForm(assets / "forms" / "doublet-view.json");
  const analytics::FormItem item = form.items().front();
  ASSERT_FALSE(item.anchors.empty());
  RatingFormView view;
  view.resize(500, 700);
  view.setForm(&form);
  view.show();
  QTest::qWait(50);
  const QList<QLabel*> anchors = view.findChildren<QLabel*>(QString::fromStdString(item.key) + "-anchor");
  ASSERT_EQ(anchors.size(), form.most - form.least + 1);
  for (int score = form.least; score <= form.most; ++score) {
    QLabel* const words = anchors[score - form.least];
    auto* const button = view.findChild<QRadioButton*>(QString::fromStdString(item.key) + '=' + QString::number(score));
    ASSERT_NE(button, nullptr);
    EXPECT_EQ(words->text().toStdString(), item.anchors[static_cast<std::size_t>(score - form.least)]);
    const int middle = button->mapTo(&view, QPoint(0, button->height() / 2)).y();
    const int top = words->mapTo(&view, QPoint()).y();
    EXPECT_TRUE(top <= middle && middle <= top + words->height()) << "beside its button";
    QTest::mouseClick(words, Qt::LeftButton);
    EXPECT_TRUE(button->isChecked()) << "a click on the words is one on the button";
    EXPECT_EQ(view.answers().at(item.key), score);
  }
}

class Rater : public test::AssessedCohort {
 protected:
  void SetUp() override {
    test::AssessedCohort::SetUp();
    drafts::keepRater({});
  }
  std::unique_ptr<DashboardWindow> opened(const char* rater = "R1") {
    auto window = std::make_unique<DashboardWindow>(apps::assessProgram(), std::vector<fs::path>{assets});
    window->resize(1366, 768);
    window->show();
    EXPECT_TRUE(window->openDatabase(file("c.db")));
    showPage(*window, 7);
    window->activateWindow();
    EXPECT_TRUE(QTest::qWaitForWindowActive(window.get()));
    if (rater != nullptr) {
      auto& name = *child<QLineEdit>(*window, "rater");
      name.clear();
      QTest::keyClicks(&name, rater);
      QTest::keyClick(&name, Qt::Key_Tab);
      emit name.editingFinished();
    }
    window->findChild<RatingPage*>()->chooseForm("goals");
    return window;
  }
  /// Plays the film, by key, until enough of it was seen: a busy machine may leave out a second at the first time.
  static bool watch(DashboardWindow& window) {
    auto& page = *window.findChild<RatingPage*>();
    auto& film = *page.findChild<RecordingView*>();
    if (!QTest::qWaitFor([&] { return film.isOpen(); }, patience)) return false;
    for (int time = 0; time < 20 && !page.seenFilm().suffices(); ++time) {
      film.replay().pause();
      film.replay().seek(0.0);
      const auto begins = [&] { return film.replay().position().step == 0 && !film.replay().position().playing; };
      if (!QTest::qWaitFor([&] { return begins() && page.settled(); }, patience)) return false;
      QTest::keyClick(&page, Qt::Key_Space, Qt::ControlModifier);
      const auto ended = [&] { return film.replay().position().step + 1 == film.replay().position().steps; };
      if (!QTest::qWaitFor([&] { return page.seenFilm().suffices() || ended(); }, patience)) return false;
      QTest::qWait(200);
    }
    return page.seenFilm().suffices();
  }
  static void answer(QWidget& window, int score) {
    for (const char* item : {"depth-perception", "bimanual-dexterity", "efficiency", "tissue-handling", "autonomy"})
      child<QRadioButton>(window, (std::string(item) + '=' + std::to_string(score)).c_str())->click();
  }
  static int row(DashboardWindow& window) { return child<QListView>(window, "rating-queue")->currentIndex().row(); }
  static QString textAt(DashboardWindow& window, int row) {
    return child<QListView>(window, "rating-queue")->model()->index(row, 0).data().toString();
  }
  [[nodiscard]] std::vector<analytics::Rating> ratings() const {
    return analytics::CohortDatabase(file("c.db").toStdString(), Access::read).ratings();
  }
};

TEST_F(Rater, StoresWhatWasSeenAndGoesOnByKey) {
  const auto window = opened();
  RatingPage& page = *window->findChild<RatingPage*>();
  EXPECT_FALSE(child<QLabel>(page, "identity")->isVisible()) << "blinded";
  expectHolds(child<QLabel>(page, "rating-progress")->text().toStdString(), {"0", "2"});
  const int first = row(*window);
  answer(page, 4);
  QPushButton& next = *child<QPushButton>(page, "store-next");
  auto& film = *page.findChild<RecordingView*>();
  ASSERT_TRUE(QTest::qWaitFor([&] { return film.isOpen(); }, patience));
  child<QSlider>(page, "scrub")->setValue(9000);
  ASSERT_TRUE(QTest::qWaitFor([&] { return page.settled(); }, patience));
  EXPECT_EQ(page.seenFilm().share(), 0.0) << "a jump is no watching";
  EXPECT_FALSE(next.isEnabled());
  QTest::keyClick(&page, Qt::Key_Return, Qt::ControlModifier);
  EXPECT_TRUE(ratings().empty());
  ASSERT_TRUE(watch(*window));
  ASSERT_TRUE(next.isEnabled()) << child<QLabel>(page, "rating-state")->text().toStdString();
  QSignalSpy shown(window.get(), &DashboardWindow::documentShown);
  auto* const button = child<QRadioButton>(page, "efficiency=4");
  button->setFocus();
  QTest::keyClick(button, Qt::Key_Return, Qt::ControlModifier);
  EXPECT_NE(row(*window), first) << "the next one, at once";
  EXPECT_FALSE(button->isChecked());
  EXPECT_FALSE(next.isEnabled());
  ASSERT_TRUE(shown.wait(patience));
  ASSERT_EQ(ratings().size(), 1U);
  EXPECT_EQ(ratings()[0].rater, "R1");
  EXPECT_EQ(ratings()[0].answers.at("efficiency"), 4);
  expectHolds(child<QLabel>(page, "rating-progress")->text().toStdString(), {"1", "2"});
  EXPECT_NE(textAt(*window, first),
            textAt(*window, row(*window)).replace(QString::number(row(*window) + 1), QString::number(first + 1)))
      << "the first is marked as rated";
  EXPECT_TRUE(settings::person().isEmpty()) << "the rater's name goes nowhere else";
}

TEST_F(Rater, TakesTheLastRatingBackWithItsAnswers) {
  const auto window = opened();
  RatingPage& page = *window->findChild<RatingPage*>();
  const int first = row(*window);
  answer(page, 3);
  ASSERT_TRUE(watch(*window));
  QSignalSpy shown(window.get(), &DashboardWindow::documentShown);
  QTest::keyClick(&page, Qt::Key_Return, Qt::ControlModifier);
  ASSERT_TRUE(shown.wait(patience));
  ASSERT_EQ(ratings().size(), 1U);
  QTest::keyClick(window.get(), Qt::Key_Z, Qt::ControlModifier);
  ASSERT_TRUE(shown.wait(patience));
  EXPECT_TRUE(ratings().empty());
  EXPECT_EQ(row(*window), first);
  EXPECT_TRUE(child<QRadioButton>(page, "efficiency=3")->isChecked()) << "to be changed";
  ASSERT_TRUE(QTest::qWaitFor([&] { return child<QPushButton>(page, "store-rating")->isEnabled(); }, patience))
      << "the film was seen before";
  // What replaces a rating gives way to it again.
  child<QPushButton>(page, "store-rating")->click();
  ASSERT_TRUE(shown.wait(patience));
  child<QRadioButton>(page, "efficiency=1")->click();
  child<QPushButton>(page, "store-rating")->click();
  ASSERT_TRUE(shown.wait(patience));
  EXPECT_EQ(ratings().at(0).answers.at("efficiency"), 1);
  QTest::keyClick(window.get(), Qt::Key_Z, Qt::ControlModifier);
  ASSERT_TRUE(shown.wait(patience));
  EXPECT_EQ(ratings().at(0).answers.at("efficiency"), 3);
  QTest::keySequence(window.get(), QKeySequence::Redo);
  ASSERT_TRUE(shown.wait(patience));
  EXPECT_EQ(ratings().at(0).answers.at("efficiency"), 1) << "done again";
}

TEST_F(Rater, IsCalledAwayAndGoesOnWhereTheyWere) {
  {
    const auto window = opened();
    ASSERT_TRUE(watch(*window));
    child<QRadioButton>(*window, "efficiency=3")->click();
  }
  const auto window = opened(nullptr);
  RatingPage& page = *window->findChild<RatingPage*>();
  EXPECT_EQ(child<QLineEdit>(page, "rater")->text(), "R1");
  EXPECT_TRUE(child<QRadioButton>(page, "efficiency=3")->isChecked()) << "the draft was kept";
  ASSERT_TRUE(QTest::qWaitFor([&] { return page.seenFilm().suffices(); }, patience)) << "and what was seen";
  answer(page, 2);
  EXPECT_TRUE(child<QPushButton>(page, "store-rating")->isEnabled());
  // Another rater has seen nothing and answered nothing.
  auto& name = *child<QLineEdit>(page, "rater");
  name.setText("R2");
  emit name.editingFinished();
  EXPECT_FALSE(child<QRadioButton>(page, "efficiency=2")->isChecked());
  EXPECT_EQ(page.seenFilm().share(), 0.0);
}

TEST_F(Rater, StaysBlindedUnlessAskedOtherwise) {
  fs::copy_file(root_ / "c.db", root_ / "bad.h5", fs::copy_options::overwrite_existing);
  for (const char* name : {"one.h5", "two.h5"})
    fs::copy_file(root_ / "bad.h5", root_ / name, fs::copy_options::overwrite_existing);
  const auto window = opened();
  RatingPage& page = *window->findChild<RatingPage*>();
  auto& film = *page.findChild<RecordingView*>();
  ASSERT_TRUE(QTest::qWaitFor([&] { return page.settled(); }, patience));
  EXPECT_FALSE(film.isOpen());
  const auto namesAnybody = [&] {
    for (const QLabel* label : page.findChildren<QLabel*>()) {
      if (label->isVisible() && (label->text().contains("skilled") || label->text().contains(".h5"))) return true;
    }
    return film.text().contains(".h5") || film.text().contains("skilled");
  };
  EXPECT_FALSE(namesAnybody()) << "not even where the film cannot be shown";
  child<QCheckBox>(page, "reveal")->click();
  EXPECT_TRUE(child<QLabel>(page, "identity")->isVisible());
  EXPECT_TRUE(namesAnybody());
}

TEST_F(Rater, LimitsTheQueueToWhatIsSelected) {
  const auto window = opened();
  auto& which = *child<QComboBox>(*window, "rating-films");
  which.setCurrentIndex(1);
  EXPECT_EQ(child<QListView>(*window, "rating-queue")->model()->rowCount(), 1) << "the one that is selected at first";
  expectHolds(which.currentText().toStdString(), {"1"});
}

}  // namespace
}  // namespace calot::gui
