// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/scenes_page.h"

#include <algorithm>
#include <QComboBox>
#include <QIcon>
#include <QLabel>
#include <QListWidget>
#include <QPixmap>
#include <QPushButton>
#include <system_error>
#include <utility>

#include "gui/attempt/figure_text.h"
#include "gui/attempt/widget_parts.h"
#include "gui/trainer/trainer_texts.h"
#include "recorder/base/errors.h"

namespace calot::gui {

using Access = analytics::CohortDatabase::Access;

std::vector<PastAttempt> historyIn(const std::filesystem::path& cohort, const std::string& participant) {
  std::error_code ignored;
  if (participant.empty() || cohort.empty() || !std::filesystem::exists(cohort, ignored)) return {};
  const analytics::CohortDatabase database(cohort.string(), Access::read);
  const std::vector<analytics::Norm> norms = database.norms();
  std::vector<PastAttempt> history;
  for (const analytics::AttemptRow& row : database.listAttempts()) {
    if (row.participant != participant || row.synthetic) continue;
    PastAttempt past{row.scene, row.startUtc, static_cast<double>(row.steps) * row.stepSeconds,
                     row.mode,  row.outcome,  !row.parent.empty(),
                     {},        false};
    if (const auto fitting = normsFor(row, norms); !fitting.empty()) {
      const AttemptStanding standing = standingOf(row, database.values(row.uuid), *fitting.front());
      if (standing.judged) past.verdict = QString::fromStdString(standing.verdict);
      past.passed = standing.judged && standing.grade && standing.grade->passed;
    }
    history.push_back(std::move(past));
  }
  std::reverse(history.begin(), history.end());
  return history;
}

QString progressText(const std::vector<PastAttempt>& history, const std::string& scene) {
  int attempts = 0, completed = 0;
  bool passed = false;
  for (const PastAttempt& past : history) {
    if (past.scene != scene || past.branch) continue;
    ++attempts;
    completed += past.outcome == recorder::Outcome::completed ? 1 : 0;
    passed = passed || past.passed;
  }
  if (attempts == 0) return "Not tried yet";
  QString text = attempts == 1 ? QString("1 attempt") : QString("%1 attempts").arg(attempts);
  text += passed ? QString(", passed by the norm") : QString(", %1 completed").arg(completed);
  return (passed || completed > 0 ? QString::fromUtf8("✓ ") : QString()) + text;
}

QString pastText(const PastAttempt& attempt) {
  QString text = QString("%1, %2%3: %4 after %5")
                     .arg(startText(attempt.startUtc), modeText(attempt.mode), attempt.branch ? ", a branch" : "",
                          outcomeText(attempt.outcome), clockText(attempt.seconds));
  return attempt.verdict.isEmpty() ? text : text + ". " + attempt.verdict;
}

namespace {

constexpr QSize pictureSize(160, 90);  // five of them on a screen of 768 lines, also in large letters

/// "2. Carve (carve-fat)" and the goal; of a scene in no course its name and summary.
QString titleOf(const SceneChoice& scene, std::size_t number) {
  if (scene.title.empty()) return QString::fromStdString(scene.name + "\n" + scene.summary);
  return QString("%1. %2 (%3)\n%4")
      .arg(number)
      .arg(QString::fromStdString(scene.title), QString::fromStdString(scene.name), QString::fromStdString(scene.goal));
}

}  // namespace

ScenesPage::ScenesPage(bool demonstrates)
    : list_(parts::named("scenes", new QListWidget)),
      past_(parts::named("past", new QListWidget)),
      pastTitle_(parts::plainLabel("pastTitle")),
      text_(new QLabel),
      modeNote_(parts::plainLabel("mode-note")),
      mode_(parts::named("mode-choice", new QComboBox)),
      calibration_(parts::button("&Calibration …", "calibration")),
      demonstrates_(demonstrates),
      pastSide_(parts::boxed(parts::column({pastTitle_, {past_, 1}}))),
      begin_(parts::button("&Begin", "begin")),
      tutorial_(parts::button("&Learn the controls", "tutorial")),
      demonstration_(parts::button("&Watch a demonstration", "demonstration")) {
  auto* const title = new QLabel("Welcome to the trainer");
  parts::enlarge(title, 1.6);
  text_->setWordWrap(true);
  mode_->addItem("Practice", static_cast<int>(recorder::Mode::practice));
  mode_->addItem("Assessment", static_cast<int>(recorder::Mode::assessment));
  calibration_->setToolTip("Of the device that drives the hands: an assessment needs one");
  list_->setAccessibleName("Scenes");
  list_->setWordWrap(true);
  list_->setIconSize(pictureSize);
  list_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);  // texts are wrapped
  list_->setStyleSheet("QListWidget::item { padding: 6px; }");
  past_->setAccessibleName("Your attempts at this task");
  past_->setWordWrap(true);
  pastTitle_->setAlignment(Qt::AlignTop | Qt::AlignLeft);  // also where there is no list below it
  tutorial_->setToolTip("Asks for one control after the other, on the first task's scene");
  demonstration_->setToolTip("A skilled performer does it: a program, no person; its recording is marked synthetic");
  for (QPushButton* const button : {begin_, tutorial_, demonstration_}) button->setEnabled(false);

  pastSide_->hide();
  QFrame* const column =
      parts::sheet(parts::column({title,
                                  text_,
                                  parts::row({{"&Mode", mode_}, calibration_, modeNote_, parts::spring()}),
                                  parts::space(6),
                                  {parts::row({{list_, 3}, {pastSide_, 2}}), 1},
                                  parts::row({tutorial_, parts::spring(), demonstration_, parts::primary(begin_)})}));
  column->setMaximumWidth(1300);
  QBoxLayout* const outer = parts::row({parts::spring(), {column, 20}, parts::spring()});
  outer->setContentsMargins(16, 8, 16, 8);
  setLayout(outer);

  connect(mode_, &QComboBox::activated, this,
          [this] { emit modeChosen(static_cast<recorder::Mode>(mode_->currentData().toInt())); });
  connect(calibration_, &QPushButton::clicked, this, &ScenesPage::calibrationRequested);
  const auto choose = [this](Purpose purpose) {
    const int row = list_->currentRow();
    if (row >= 0) emit chosen(QString::fromStdString(choices_[static_cast<std::size_t>(row)].file.string()), purpose);
  };
  connect(list_, &QListWidget::itemActivated, this, [choose] { choose(Purpose::own); });
  connect(list_, &QListWidget::currentRowChanged, this, [this](int row) {
    for (QPushButton* const button : {begin_, demonstration_}) button->setEnabled(row >= 0);
    showPast();
  });
  connect(begin_, &QPushButton::clicked, this, [choose] { choose(Purpose::own); });
  connect(demonstration_, &QPushButton::clicked, this, [choose] { choose(Purpose::demonstration); });
  connect(tutorial_, &QPushButton::clicked, this, [this] {
    if (!choices_.empty()) emit chosen(QString::fromStdString(choices_.front().file.string()), Purpose::controls);
  });
}

void ScenesPage::showMode(recorder::Mode mode, const QString& note) {
  const bool practice = mode == recorder::Mode::practice;
  mode_->setCurrentIndex(mode_->findData(static_cast<int>(mode)));
  text_->setText(
      practice
          ? "Choose what to practise; the tasks become harder from the top. Every attempt is recorded; you can pause, "
            "and go back to before a mistake and try again. Time starts with your first motion."
          : "Choose a task. Every attempt is recorded and can be assessed; there is no pause and no going back. Time "
            "starts with your first motion.");
  calibration_->setVisible(!practice || !note.isEmpty());
  parts::say(modeNote_, note);
  tutorial_->setVisible(practice);
  demonstration_->setVisible(practice && demonstrates_);
}

void ScenesPage::setScenes(const std::vector<SceneChoice>& scenes) {
  list_->clear();
  choices_ = scenes;
  for (const SceneChoice& scene : choices_) {
    auto* const item = new QListWidgetItem(list_);
    if (scene.picture.empty()) continue;
    const QPixmap picture(QString::fromStdString(scene.picture.string()));
    QIcon icon(picture);
    icon.addPixmap(picture, QIcon::Selected);  // not tinted
    item->setIcon(icon);
  }
  showTexts();
  tutorial_->setEnabled(!choices_.empty());
  if (!choices_.empty()) list_->setCurrentRow(0);
}

void ScenesPage::showTexts() {
  for (std::size_t i = 0; i < choices_.size(); ++i) {
    QString text = titleOf(choices_[i], i + 1);
    if (history_) text += '\n' + progressText(*history_, choices_[i].name);
    list_->item(static_cast<int>(i))->setText(text);
  }
}

void ScenesPage::setHistory(std::optional<std::vector<PastAttempt>> history) {
  history_ = std::move(history);
  showTexts();
  showPast();
}

void ScenesPage::showPast() {
  const int row = list_->currentRow();
  pastSide_->setVisible(history_.has_value() && row >= 0);
  if (!history_ || row < 0) return;
  const SceneChoice& scene = choices_[static_cast<std::size_t>(row)];
  past_->clear();
  for (const PastAttempt& attempt : *history_) {
    if (attempt.scene == scene.name) past_->addItem(pastText(attempt));
  }
  past_->setVisible(past_->count() > 0);
  pastTitle_->setText(past_->count() > 0 ? "Your attempts at it, from the cohort:"
                                         : "You have no attempts at this task yet.");
}

void ScenesPage::focusList() { list_->setFocus(); }

}  // namespace calot::gui
