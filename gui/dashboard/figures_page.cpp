// SPDX-License-Identifier: GPL-3.0-or-later

#include "gui/dashboard/figures_page.h"

#include <algorithm>
#include <exception>
#include <QBoxLayout>
#include <QCheckBox>
#include <QComboBox>
#include <QHeaderView>
#include <QLabel>
#include <QSignalBlocker>
#include <QSplitter>
#include <QTableWidget>

#include "analytics/assessment/grade.h"
#include "gui/attempt/figure_standing.h"
#include "gui/attempt/figure_text.h"
#include "gui/attempt/theme.h"
#include "gui/attempt/widget_parts.h"
#include "gui/dashboard/page_parts.h"
#include "gui/dashboard/plot_view.h"
#include "gui/words/problem_words.h"
#include "recorder/base/errors.h"

namespace calot::gui {

FiguresPage::FiguresPage(const char* captionName, QWidget* parent) : QWidget(parent), caption_(new QLabel(this)) {
  caption_->setObjectName(captionName);
  caption_->setTextFormat(Qt::PlainText);
  caption_->setWordWrap(true);
}

void FiguresPage::setDocument(std::shared_ptr<const CohortDocument> document) {
  document_ = std::move(document);
  read_ = ready_ = false;
  if (isVisible()) readValues();
}

void FiguresPage::showEvent(QShowEvent* event) {
  QWidget::showEvent(event);
  readValues();
}

void FiguresPage::readValues() {
  if (read_ || !document_) return;
  read_ = true;
  ready_ = false;
  caption_->setText("Reading the values …");
  background_.run([this, document = document_]() -> Background::Completion {
    std::shared_ptr<const FigureValues> values;
    QString fault;
    try {
      values = document->figureValues();
    } catch (const std::exception& error) {
      fault = QString::fromStdString(problemText(error));
    }
    return [this, values, fault] {
      if (!fault.isEmpty()) emit problem(fault);
      values_ = values;
      ready_ = true;
      takeValues();
    };
  });
}

void FiguresPage::fillFigures(QComboBox* box) const {
  const QString chosen = box->currentText();
  box->clear();
  if (values_) {
    for (const Figure& f : values_->figures()) box->addItem(figureTitle(f.name, f.subject));
  }
  box->setCurrentIndex(std::max(0, box->findText(chosen)));
}

QComboBox* FiguresPage::addChoice(QHBoxLayout* row, const char* name, const char* text, int stretch) {
  auto* const box = parts::choice(name, 13);
  parts::labelled(*row, text, box, stretch);
  return box;
}

ComparePage::ComparePage(QWidget* parent) : FiguresPage("caption", parent) {
  auto* layout = new QVBoxLayout(this);
  auto* upper = new QHBoxLayout;
  auto* lower = new QHBoxLayout;  // keys are long: they have a line of their own
  figure_ = addChoice(upper, "figure", "&Checkpoint", 3);
  groupBy_ = addChoice(upper, "group-by", "&By", 1);
  key_ = addChoice(lower, "key", "Comparable &within", 3);
  groupBy_->addItems({"group", "performer's profile", "participant"});
  for (QComboBox* const box : {figure_, groupBy_, key_})
    connect(box, &QComboBox::currentIndexChanged, this, [this] { redraw(); });
  synthetic_ = parts::named("synthetic", new QCheckBox("&Synthetic attempts"));
  synthetic_->setChecked(true);
  connect(synthetic_, &QCheckBox::toggled, this, [this] { redraw(); });
  lower->addWidget(synthetic_);
  layout->addLayout(upper);
  layout->addLayout(lower);
  chart_ = new PlotView("comparison-chart", "Attempts by group");
  connect(chart_, &PlotView::attemptChosen, this, &ComparePage::attemptActivated);
  layout->addWidget(chart_, 1);
  setProperty(beginProperty, QVariant::fromValue<QObject*>(figure_));
  layout->addWidget(caption());
}

void ComparePage::takeValues() {
  keys_ = comparabilityKeysOf(document().attempts());
  {
    const QSignalBlocker quietFigure(figure_), quietKey(key_), quietGroup(groupBy_);
    fillFigures(figure_);
    const QString key = key_->currentText();
    key_->clear();
    for (const std::string& k : keys_) key_->addItem(QString::fromStdString(k));
    key_->setCurrentIndex(std::max(0, key_->findText(key)));
    // Nobody has a study group: then profiles tell more.
    bool grouped = false;
    for (const analytics::AttemptRow& attempt : document().attempts()) grouped = grouped || !attempt.group.empty();
    groupBy_->setCurrentIndex(static_cast<int>(grouped ? GroupBy::group : GroupBy::profile));
  }
  redraw();
}

void ComparePage::redraw() {
  if (!ready()) return;
  ComparisonRequest request;
  request.groupBy = static_cast<GroupBy>(groupBy_->currentIndex());
  request.includeSynthetic = synthetic_->isChecked();
  const int figure = figure_->currentIndex(), key = key_->currentIndex();
  if (figure < 0 || key < 0) {
    chart_->clear("No checkpoint has a value yet");
    caption()->clear();
    return;
  }
  request.figure = values()->figures()[static_cast<std::size_t>(figure)];
  request.comparabilityKey = keys_[static_cast<std::size_t>(key)];
  const Comparison comparison = compare(document().attempts(), values()->of(static_cast<std::size_t>(figure)), request);
  const QString title = figureTitle(request.figure.name, request.figure.subject);
  chart_->show(
      comparison.group.empty() ? title + ": nothing to show" : title,
      [comparison, name = title.toStdString()](const analytics::PlotFrame& frame) {
        return drawComparison(comparison, name, frame);
      },
      comparison.synthetic);
  caption()->setText(QString::fromStdString(captionOf(comparison)));
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

TraineePage::TraineePage(QWidget* parent) : FiguresPage("trainee-caption", parent) {
  auto* layout = new QVBoxLayout(this);
  auto* upper = new QHBoxLayout;
  auto* lower = new QHBoxLayout;  // keys are long: they have a line of their own
  trainee_ = addChoice(upper, "trainee", "T&rainee", 1);
  figure_ = addChoice(upper, "trainee-figure", "&Checkpoint", 3);
  key_ = addChoice(lower, "trainee-key", "Comparable &within", 3);
  layout->addLayout(upper);
  layout->addLayout(lower);
  goal_ = parts::plainLabel("trainee-goal");
  parts::embolden(goal_);
  layout->addWidget(goal_);
  tasks_ = parts::named("trainee-tasks", new QTableWidget(0, 5));
  tasks_->setAccessibleName("Tasks of the trainee");
  tasks_->setHorizontalHeaderLabels({"Task", "Attempts", "First", "Last", "Last started"});
  tasks_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  tasks_->setSelectionBehavior(QAbstractItemView::SelectRows);
  tasks_->setTabKeyNavigation(false);
  tasks_->setToolTip("Double-click, or press Enter, to see a task's history");
  tasks_->verticalHeader()->hide();
  tasks_->verticalHeader()->setDefaultSectionSize(tasks_->fontMetrics().height() + 9);
  tasks_->horizontalHeader()->setStretchLastSection(true);
  tasks_->setColumnWidth(0, theme::inType(560));
  chart_ = new PlotView("history-chart", "A figure over the attempts");
  table_ = parts::named("trainee-attempts", new QTableWidget(0, 6));
  table_->setAccessibleName("Attempts of the trainee");
  table_->setHorizontalHeaderLabels({"No.", "Started", "Value", "Outcome", "Verification", "Remark"});
  table_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  table_->setSelectionBehavior(QAbstractItemView::SelectRows);
  table_->setTabKeyNavigation(false);
  table_->setAlternatingRowColors(true);
  table_->setToolTip("Double-click, or press Enter, to open an attempt");
  table_->verticalHeader()->hide();
  table_->verticalHeader()->setDefaultSectionSize(table_->fontMetrics().height() + 9);
  table_->horizontalHeader()->setStretchLastSection(true);
  table_->horizontalHeader()->setDefaultAlignment(Qt::AlignLeft | Qt::AlignVCenter);
  int column = 0;
  for (const int width : {50, 170, 130, 130, 170}) table_->setColumnWidth(column++, theme::inType(width));
  auto* splitter = new QSplitter(Qt::Vertical);
  splitter->addWidget(chart_);
  splitter->addWidget(tasks_);
  splitter->addWidget(table_);
  splitter->setSizes({400, 110, 180});
  splitter->setStretchFactor(0, 3);
  splitter->setStretchFactor(1, 2);
  splitter->setChildrenCollapsible(false);
  layout->addWidget(splitter, 1);
  layout->addWidget(caption());
  connectParts();
  setProperty(beginProperty, QVariant::fromValue<QObject*>(trainee_));
}

void TraineePage::connectParts() {
  connect(trainee_, &QComboBox::currentIndexChanged, this, [this] {
    if (ready()) fillKeys();
    redraw();
  });
  for (QComboBox* box : {figure_, key_}) connect(box, &QComboBox::currentIndexChanged, this, [this] { redraw(); });
  connect(tasks_, &QTableWidget::itemActivated, this, [this](const QTableWidgetItem* item) {
    key_->setCurrentIndex(key_->findText(tasks_->item(item->row(), 0)->data(Qt::UserRole).toString()));
  });
  connect(chart_, &PlotView::attemptChosen, this, &TraineePage::attemptActivated);
  connect(table_, &QTableWidget::itemActivated, this, [this](const QTableWidgetItem* item) {
    emit attemptActivated(table_->item(item->row(), 0)->data(Qt::UserRole).toString());
  });
}

void TraineePage::takeValues() {
  trainees_ = traineesOf(document().attempts());
  {
    const QSignalBlocker quietTrainee(trainee_), quietFigure(figure_);
    const QString trainee = trainee_->currentText();
    trainee_->clear();
    for (const Trainee& t : trainees_)
      trainee_->addItem(QString::fromStdString(t.name) + (t.synthetic ? " (performer)" : ""));
    trainee_->setCurrentIndex(std::max(0, trainee_->findText(trainee)));
    fillFigures(figure_);
  }
  fillKeys();
  redraw();
}

void TraineePage::fillKeys() {
  const QSignalBlocker quiet(key_);
  key_->clear();
  const int at = trainee_->currentIndex();
  if (at < 0) return;
  for (const std::string& key : keysOf(document().attempts(), trainees_[static_cast<std::size_t>(at)]))
    key_->addItem(QString::fromStdString(key));
}

void TraineePage::redraw() {
  if (!ready()) return;
  const int trainee = trainee_->currentIndex(), figure = figure_->currentIndex();
  if (trainee < 0 || figure < 0 || key_->currentIndex() < 0) {
    chart_->clear("No attempts: nothing to show");
    caption()->setText("No attempt has a participant or a profile yet.");
    table_->setRowCount(0);
    tasks_->setRowCount(0);
    goal_->clear();
    return;
  }
  std::vector<analytics::Norm> none;
  const std::vector<analytics::Norm>* norms = &none;
  try {
    norms = &document().norms();
  } catch (const Error& error) {
    emit problem(QString::fromStdString(problemText(error)));
  }
  const auto index = static_cast<std::size_t>(figure);
  const Figure& shown = values()->figures()[index];
  const TraineeHistory history =
      historyOf(document().attempts(), values()->of(index), *norms, trainees_[static_cast<std::size_t>(trainee)], shown,
                key_->currentText().toStdString());
  const QString title = trainee_->currentText() + ": " + figureTitle(shown.name, shown.subject);
  const auto& all = history.attempts;
  const bool empty = std::none_of(all.begin(), all.end(), [](const HistoryAttempt& a) { return a.value.has_value(); });
  chart_->show(
      empty && !history.cut ? title + ": nothing to show" : title,
      [history, name = title.toStdString()](const analytics::PlotFrame& frame) {
        return drawTraineeHistory(history, name, frame);
      },
      std::any_of(all.begin(), all.end(), [](const HistoryAttempt& a) { return a.attempt->synthetic; }));
  caption()->setText(curveText(history));
  fillTable(history);
  fillTasks(trainees_[static_cast<std::size_t>(trainee)], index, *norms);
  showGoal(history, *norms);
}

void TraineePage::fillTasks(const Trainee& trainee, std::size_t figure, const std::vector<analytics::Norm>& norms) {
  const std::vector<std::string> keys = keysOf(document().attempts(), trainee);
  tasks_->setRowCount(static_cast<int>(keys.size()));
  for (int row = 0; row < tasks_->rowCount(); ++row) {
    const std::string& key = keys[static_cast<std::size_t>(row)];
    const TraineeHistory history =
        historyOf(document().attempts(), values()->of(figure), norms, trainee, values()->figures()[figure], key);
    QString first = "none", last = "none";
    for (const HistoryAttempt& entry : history.attempts) {
      if (!entry.value) continue;
      const QString text = (numberText(*entry.value) + ' ' + QString::fromStdString(history.unit)).trimmed();
      if (first == "none") first = text;
      last = text;
    }
    const QStringList texts{
        QString::fromStdString(analytics::comparabilityWords(key)), QString::number(history.attempts.size()), first,
        last, history.attempts.empty() ? QString() : startText(history.attempts.back().attempt->startUtc)};
    for (int column = 0; column < texts.size(); ++column)
      tasks_->setItem(row, column, new QTableWidgetItem(texts[column]));
    tasks_->item(row, 0)->setData(Qt::UserRole, QString::fromStdString(key));
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
  try {
    own = document().values(newest.uuid);
  } catch (const Error& error) {
    emit problem(QString::fromStdString(problemText(error)));
  }
  const AttemptStanding standing = standingOf(newest, own, *fitting.front());
  goal_->setText(standing.grade ? "Next goal: " + QString::fromStdString(analytics::nextGoal(*standing.grade).text)
                                : "No goal: " + QString::fromStdString(standing.verdict));
}

void TraineePage::fillTable(const TraineeHistory& history) {
  table_->setRowCount(static_cast<int>(history.attempts.size()));
  for (int row = 0; row < table_->rowCount(); ++row) {
    const HistoryAttempt& entry = history.attempts[static_cast<std::size_t>(row)];
    const Badge badge = badgeOf(*entry.attempt);
    const QString value = entry.value ? numberText(*entry.value) + ' ' + QString::fromStdString(history.unit) : "none";
    const QStringList texts{
        QString::number(row + 1),
        startText(entry.attempt->startUtc),
        value.trimmed(),
        outcomeText(entry.attempt->outcome),
        badge.text,
        QString(QString::fromStdString(entry.why) + (entry.attempt->synthetic ? " synthetic" : "")).trimmed()};
    for (int column = 0; column < texts.size(); ++column)
      table_->setItem(row, column, new QTableWidgetItem(texts[column]));
    table_->item(row, 0)->setData(Qt::UserRole, QString::fromStdString(entry.attempt->uuid));
    table_->item(row, 4)->setForeground(badge.colour);
    table_->item(row, 4)->setToolTip(badge.explanation);
  }
}

}  // namespace calot::gui
