// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/figures_page.h"

#include <algorithm>

#include "analytics/assessment/grade.h"
#include "analytics/cohort/blinding.h"
#include "analytics/report/course_tables.h"
#include "gui/attempt/figure_text.h"
#include "gui/dashboard/course_page.h"
#include "gui/dashboard/dialogs.h"
#include "gui/dashboard/plot_view.h"
#include "gui/words/attempt_summary.h"
#include "recorder/base/errors.h"

namespace calot::gui {

FiguresPage::FiguresPage(const std::string& prefix, PlotView* chart)
    : figure_(parts::choice((prefix + "figure").c_str(), 13)),
      key_(parts::choice((prefix + "key").c_str(), 13)),
      chart_(chart),
      caption_(parts::plainLabel((prefix + "caption").c_str())) {
  for (QComboBox* choice : {figure_, key_})
    connect(choice, &QComboBox::currentIndexChanged, this, [this] { redraw(); });
  connect(chart_, &PlotView::attemptChosen, this, &CohortPage::attemptActivated);
}

void FiguresPage::read() {
  ready_ = false;
  caption_->setText("Reading the values …");
  const auto take = [this](const std::shared_ptr<const FigureValues>& values) {
    values_ = values;
    ready_ = true;
    QStringList titles;
    if (values_) {
      for (const Figure& f : values_->figures()) titles += figureTitle(f.name, f.subject);
    }
    refill(*figure_, titles);
    fillChoices();
    redraw();
  };
  background_.run([take, document = document_] { return [take, values = document->figureValues()] { take(values); }; },
                  [this, take](const QString& fault) {
                    emit problem(fault);
                    take(nullptr);
                  });
}

ComparePage::ComparePage()
    : FiguresPage("", new PlotView("comparison-chart", "Attempts by group")),
      groupBy_(parts::choice("group-by", 13)),
      synthetic_(parts::named("synthetic", new QCheckBox("&Synthetic attempts"))) {
  // Keys are long: they have a line of their own.
  setLayout(parts::column({parts::row({{"&Checkpoint", figure_, 3}, {"&By", groupBy_, 1}}),
                           parts::row({{"Comparable &within", key_, 3}, synthetic_}),
                           {chart_, 1},
                           caption_}));
  groupBy_->addItems({"group", "performer's profile", "participant"});
  synthetic_->setChecked(true);
  connect(groupBy_, &QComboBox::currentIndexChanged, this, [this] { redraw(); });
  connect(synthetic_, &QCheckBox::toggled, this, [this] { redraw(); });
  begin_ = figure_;
}

void ComparePage::fillChoices() {
  const std::vector<analytics::AttemptRow>& attempts = document_->attempts();
  refill(*key_, textsOf(comparabilityKeysOf(attempts)));
  // Nobody has a study group: then profiles tell more.
  const bool grouped = std::any_of(attempts.begin(), attempts.end(), [](const auto& a) { return !a.group.empty(); });
  const QSignalBlocker quiet(groupBy_);
  groupBy_->setCurrentIndex(static_cast<int>(grouped ? GroupBy::group : GroupBy::profile));
}

void ComparePage::redraw() {
  if (!ready()) return;
  const int figure = figure_->currentIndex();
  if (figure < 0 || key_->currentIndex() < 0) {
    chart_->clear("No checkpoint has a value yet");
    caption_->clear();
    return;
  }
  const auto by = static_cast<GroupBy>(groupBy_->currentIndex());
  try {
    if (by == GroupBy::group) analytics::refuseWhileMasked(document_->path(), "");
  } catch (const Error& e) {
    chart_->clear("Groups are masked");
    caption_->setText(QString::fromStdString(e.fault()));
    return;
  }
  const auto index = static_cast<std::size_t>(figure);
  const ComparisonRequest request{values_->figures()[index], by, key_->currentText().toStdString(),
                                  synthetic_->isChecked()};
  const Comparison comparison = compare(document_->attempts(), values_->of(index), request);
  const QString title = figure_->currentText();
  chart_->show(
      comparison.group.empty() ? title + ": nothing to show" : title,
      [comparison, name = title.toStdString()](const analytics::PlotFrame& frame) {
        return drawComparison(comparison, name, frame);
      },
      comparison.synthetic);
  caption_->setText(QString::fromStdString(captionOf(comparison)));
}

namespace {

QString curveText(const TraineeHistory& history) {
  QString text;
  if (history.curve)
    text =
        QString("Learning curve a - b / x over the attempt's number x: plateau a = %1 (standard error %2) %3, b = %4.")
            .arg(numberText(history.curve->plateau), numberText(history.curve->plateauError),
                 QString::fromStdString(history.unit), numberText(history.curve->gap));
  else
    text = "No learning curve: " + QString::fromStdString(history.curve.reason()) + '.';
  if (history.otherKeys > 0)
    text += QString(" %1 attempts of other comparability keys cannot stand beside these.").arg(history.otherKeys);
  return text;
}

}  // namespace

TraineePage::TraineePage()
    : FiguresPage("trainee-", new PlotView("history-chart", "A figure over the attempts")),
      trainee_(parts::choice("trainee", 13)),
      goal_(parts::plainLabel("trainee-goal")),
      missing_(parts::plainLabel("trainee-course")),
      tasks_(makeTextTable({"Task", "Attempts", "First", "Last", "Last started"}, "trainee-tasks",
                           "Tasks of the trainee")),
      table_(makeTextTable({"No.", "Started", "Value", "Outcome", "Verification", "Remark"}, "trainee-attempts",
                           "Attempts of the trainee")) {
  parts::embolden(goal_);
  tasks_->setToolTip("Double-click, or press Enter, to see a task's history");
  setWidths(*tasks_, {560});
  table_->setToolTip("Double-click, or press Enter, to open an attempt");
  setWidths(*table_, {50, 170, 130, 130, 170});
  QSplitter* splitter = makeSplitter(Qt::Vertical, {{chart_, 3}, {tasks_, 2}, {table_, 0}});
  splitter->setSizes({400, 110, 180});
  setLayout(parts::column({parts::row({{"T&rainee", trainee_, 1}, {"&Checkpoint", figure_, 3}}),
                           parts::row({{"Comparable &within", key_, 3}}),
                           goal_,
                           missing_,
                           {splitter, 1},
                           caption_}));
  connect(trainee_, &QComboBox::currentIndexChanged, this, [this] {
    fillKeys();
    redraw();
    showCourse();
  });
  missing_->hide();
  const auto keyOf = [](const QTableWidgetItem* item) {
    return item->tableWidget()->item(item->row(), 0)->data(Qt::UserRole).toString();
  };
  connect(tasks_, &QTableWidget::itemActivated, this,
          [this, keyOf](const QTableWidgetItem* item) { key_->setCurrentText(keyOf(item)); });
  connect(table_, &QTableWidget::itemActivated, this,
          [this, keyOf](const QTableWidgetItem* item) { emit attemptActivated(keyOf(item)); });
  begin_ = trainee_;
}

void TraineePage::fillChoices() {
  trainees_ = traineesOf(document_->attempts());
  QStringList names;
  for (const Trainee& t : trainees_) names += QString::fromStdString(t.name) + (t.synthetic ? " (performer)" : "");
  refill(*trainee_, names);
  fillKeys();
  readCourse();
}

void TraineePage::readCourse() {
  course_.reset();
  showCourse();
  const QString file = settings::course();
  if (!document_ || file.isEmpty()) return;
  courseReader_.run(
      [this, database = document_->path(), file = file.toStdString(), synthetic = settings::courseSynthetic()] {
        return [this, progress = readCourseProgress(database, file, synthetic)] {
          course_ = progress;
          showCourse();
        };
      },
      [](const QString&) {});  // the page Course says why
}

void TraineePage::showCourse() {
  const int at = trainee_->currentIndex();
  QString text;
  if (course_ && at >= 0) {
    const std::string& who = trainees_[static_cast<std::size_t>(at)].name;
    const auto person = std::ranges::find(course_->people, who, &analytics::CoursePerson::participant);
    if (person != course_->people.end()) {
      const std::string next = analytics::nextMissing(*person);
      text = QString("Course %1, proficient in %2 tasks. %3")
                 .arg(QString::fromStdString(course_->course.title),
                      QString::fromStdString(analytics::proficientOf(course_->course, *person)),
                      next.empty() ? QString("Nothing is missing.") : "Missing: " + QString::fromStdString(next) + '.');
    }
  }
  parts::say(missing_, text);
}

void TraineePage::fillKeys() {
  const int at = trainee_->currentIndex();
  refill(*key_,
         at < 0 ? QStringList() : textsOf(keysOf(document_->attempts(), trainees_[static_cast<std::size_t>(at)])));
}

void TraineePage::redraw() {
  if (!ready()) return;
  const int figure = figure_->currentIndex();
  if (trainee_->currentIndex() < 0 || figure < 0 || key_->currentIndex() < 0) {
    chart_->clear("No attempts: nothing to show");
    caption_->setText("No attempt has a participant or a profile yet.");
    table_->setRowCount(0);
    tasks_->setRowCount(0);
    goal_->clear();
    return;
  }
  std::vector<analytics::Norm> norms;
  tryTo([&] { norms = document_->norms(); });
  const auto index = static_cast<std::size_t>(figure);
  const Trainee& trainee = trainees_[static_cast<std::size_t>(trainee_->currentIndex())];
  const TraineeHistory history = historyOf(document_->attempts(), values_->of(index), norms, trainee,
                                           values_->figures()[index], key_->currentText().toStdString());
  const QString title = trainee_->currentText() + ": " + figure_->currentText();
  const auto& all = history.attempts;
  const bool empty = std::none_of(all.begin(), all.end(), [](const HistoryAttempt& a) { return a.value.has_value(); });
  chart_->show(
      empty && !history.cut ? title + ": nothing to show" : title,
      [history, name = title.toStdString(), source = document_](const analytics::PlotFrame& frame) {
        return drawTraineeHistory(history, name, frame);
      },
      std::any_of(all.begin(), all.end(), [](const HistoryAttempt& a) { return a.attempt->synthetic; }));
  caption_->setText(curveText(history));
  fillTable(history);
  fillTasks(trainee, index, norms);
  showGoal(history, norms);
}

void TraineePage::fillTasks(const Trainee& trainee, std::size_t figure, const std::vector<analytics::Norm>& norms) {
  const std::vector<std::string> keys = keysOf(document_->attempts(), trainee);
  tasks_->setRowCount(static_cast<int>(keys.size()));
  for (int row = 0; row < tasks_->rowCount(); ++row) {
    const std::string& key = keys[static_cast<std::size_t>(row)];
    const TraineeHistory history =
        historyOf(document_->attempts(), values_->of(figure), norms, trainee, values_->figures()[figure], key);
    QString first = "none", last = "none";
    for (const HistoryAttempt& entry : history.attempts) {
      if (!entry.value) continue;
      const QString text =
          (numberText(*entry.value, history.definition) + ' ' + QString::fromStdString(history.unit)).trimmed();
      if (first == "none") first = text;
      last = text;
    }
    const QStringList texts{
        QString::fromStdString(analytics::comparabilityWords(key)), QString::number(history.attempts.size()), first,
        last, history.attempts.empty() ? QString() : startText(history.attempts.back().attempt->startUtc)};
    setTexts(*tasks_, row, texts, key);
    tasks_->item(row, 0)->setToolTip(texts[0]);
  }
}

void TraineePage::showGoal(const TraineeHistory& history, const std::vector<analytics::Norm>& norms) {
  goal_->setText("No goal: there is no norm for this task yet.");
  if (history.attempts.empty()) return;
  const analytics::AttemptRow& newest = *history.attempts.back().attempt;
  const std::vector<const analytics::Norm*> fitting = normsFor(newest, norms);
  if (fitting.empty()) return;
  std::vector<analytics::CheckpointValue> own;
  tryTo([&] { own = document_->database().values(newest.uuid); });
  const AttemptStanding standing = standingOf(newest, own, *fitting.front());
  goal_->setText(standing.grade ? "Next goal: " + QString::fromStdString(nextGoal(*standing.grade).text)
                                : "No goal: " + QString::fromStdString(standing.verdict));
}

void TraineePage::fillTable(const TraineeHistory& history) {
  table_->setRowCount(static_cast<int>(history.attempts.size()));
  for (int row = 0; row < table_->rowCount(); ++row) {
    const HistoryAttempt& entry = history.attempts[static_cast<std::size_t>(row)];
    const Badge badge = badgeOf(*entry.attempt);
    const QString value =
        entry.value ? numberText(*entry.value, history.definition) + ' ' + QString::fromStdString(history.unit)
                    : "none";
    const QStringList texts{
        QString::number(row + 1),
        startText(entry.attempt->startUtc),
        value.trimmed(),
        outcomeText(entry.attempt->outcome),
        badge.text,
        QString(QString::fromStdString(entry.why) + (entry.attempt->synthetic ? " synthetic" : "")).trimmed()};
    setTexts(*table_, row, texts, entry.attempt->uuid);
    table_->item(row, 4)->setForeground(badge.colour);
    table_->item(row, 4)->setToolTip(badge.explanation);
  }
}

}  // namespace calot::gui
