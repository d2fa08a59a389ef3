// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/figure_panel.h"

#include <QBoxLayout>
#include <QComboBox>
#include <QLabel>
#include <QShortcut>
#include <QSignalBlocker>
#include <QTableView>
#include <QTabWidget>
#include <utility>

#include "gui/dashboard/band_delegate.h"
#include "gui/dashboard/figure_standing.h"
#include "gui/dashboard/table_view.h"
#include "gui/words/problem_words.h"
#include "recorder/errors.h"

namespace calot::gui {

FigurePanel::FigurePanel(QWidget* parent)
    : QWidget(parent),
      norm_(new QComboBox),
      verdict_(new QLabel),
      figureTable_(makeTable(figures_, "attempt-checkpoints", "Checkpoints of the attempt")),
      eventTable_(makeTable(events_, "events", "Events of the attempt")) {
  figureTable_->setItemDelegateForColumn(CheckpointTableModel::normColumn, new BandDelegate(figureTable_));
  setWidths(*figureTable_, {188, 76, 96, 130, 226, 110, 130, 460, 100, 60});
  wrapWords(*figureTable_);
  setWidths(*eventTable_, {80});
  auto* tabs = new QTabWidget;
  tabs->addTab(figureTable_, "&Checkpoints");
  tabs->addTab(eventTable_, "E&vents");

  norm_->setObjectName("norm");
  norm_->setAccessibleName("Norm that the attempt is held against");
  verdict_->setObjectName("verdict-of-norm");
  verdict_->setWordWrap(true);
  verdict_->setTextFormat(Qt::PlainText);
  auto* label = new QLabel("&Norm");
  label->setBuddy(norm_);
  auto* row = new QHBoxLayout;
  row->addWidget(label);
  row->addWidget(norm_);
  row->addWidget(verdict_, 1);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addLayout(row);
  layout->addWidget(tabs, 1);

  connect(norm_, &QComboBox::currentIndexChanged, this, [this] { showStanding(); });
  connect(figureTable_, &QTableView::clicked, this, [this](const QModelIndex& at) { showFigure(at.row()); });
  for (const Qt::Key key : {Qt::Key_Return, Qt::Key_Enter}) {
    connect(new QShortcut(key, figureTable_, nullptr, nullptr, Qt::WidgetShortcut), &QShortcut::activated, this,
            [this] {
              if (figureTable_->currentIndex().isValid()) showFigure(figureTable_->currentIndex().row());
            });
  }
  const auto showEvent = [this](const QModelIndex& at) { emit timeChosen(events_.at(at.row()).time); };
  connect(eventTable_, &QTableView::clicked, this, showEvent);
  connect(eventTable_, &QTableView::activated, this, showEvent);
}

void FigurePanel::setAttempt(std::shared_ptr<const CohortDocument> document, const analytics::AttemptRow& attempt) {
  document_ = std::move(document);
  attempt_ = attempt;
  wanted_.reset();
  cycle_.forget();
  events_.setEvents({});
  try {
    values_ = document_->values(attempt.uuid);
    intervals_ = document_->intervals(attempt.uuid);
  } catch (const Error& error) {
    values_.clear();
    intervals_.clear();
    emit problem(QString::fromStdString(problemText(error)));
  }
  figures_.setValues(values_, intervals_);
  figureTable_->setColumnHidden(CheckpointTableModel::intervalColumn, !figures_.hasIntervals());
  {
    const QSignalBlocker quiet(norm_);
    norm_->clear();
    for (const analytics::Norm* norm : normsFor(attempt, document_->norms()))
      norm_->addItem(QString("%1, version %2").arg(QString::fromStdString(norm->name)).arg(norm->version));
  }
  norm_->setEnabled(norm_->count() > 0);
  showStanding();
}

void FigurePanel::clear() {
  document_.reset();
  attempt_.reset();
  wanted_.reset();
  values_.clear();
  intervals_.clear();
  figures_.setValues({});
  events_.setEvents({});
  {
    const QSignalBlocker quiet(norm_);
    norm_->clear();
  }
  norm_->setEnabled(false);
  verdict_->clear();
}

void FigurePanel::setMoments(const std::vector<analytics::FigureMoments>& moments) {
  figures_.setMomentsText({});
  figures_.setMoments(moments);
  if (const auto wanted = std::exchange(wanted_, std::nullopt)) goToFigure(wanted->first, wanted->second);
}

void FigurePanel::showStanding() {
  const auto norms = attempt_ ? normsFor(*attempt_, document_->norms()) : std::vector<const analytics::Norm*>();
  figureTable_->setColumnHidden(CheckpointTableModel::normColumn, norms.empty());
  const int at = norm_->currentIndex();
  if (at < 0 || static_cast<std::size_t>(at) >= norms.size()) {
    verdict_->setText("There is no norm for attempts of this kind (calot norm create).");
    figures_.setStandings({});
    return;
  }
  const AttemptStanding standing = standingOf(*attempt_, values_, *norms[static_cast<std::size_t>(at)], intervals_);
  verdict_->setText(QString::fromStdString(standing.verdict));
  figures_.setStandings(standing.figures);
}

void FigurePanel::showFigure(int row) {
  const analytics::FigureMoments* found = figures_.moments(row);
  if (found == nullptr) return;
  std::vector<std::pair<double, double>> windows;
  for (const analytics::Moment& moment : found->moments) windows.emplace_back(moment.begin, moment.end);
  emit windowsChosen(windows);
  if (const auto time = cycle_.next(*found)) emit timeChosen(*time);
}

void FigurePanel::goToFigure(const std::string& checkpoint, const std::string& subject) {
  for (int row = 0; row < figures_.rowCount(); ++row) {
    const analytics::CheckpointValue& value = figures_.value(row);
    if (value.name != checkpoint || value.subject != subject) continue;
    figureTable_->selectRow(row);
    figureTable_->scrollTo(figures_.index(row, 0));
    if (figures_.moments(row) != nullptr)
      showFigure(row);
    else
      wanted_ = {checkpoint, subject};
    return;
  }
}

void FigurePanel::showWorst() {
  int chosen = -1;
  for (int row = 0; row < figures_.rowCount(); ++row) {
    const analytics::FigureMoments* found = figures_.moments(row);
    if (found == nullptr || found->moments.empty()) continue;
    const FigureStanding* standing = figures_.standing(row);
    const bool weak = standing != nullptr && standing->passed && !*standing->passed;
    if (chosen < 0 || weak) chosen = row;
    if (weak) break;
  }
  if (chosen < 0) return;
  figureTable_->selectRow(chosen);
  showFigure(chosen);
}

}  // namespace calot::gui
