// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/figure_panel.h"

#include <algorithm>
#include <cmath>
#include <QTabWidget>

#include "analytics/report/key_figures.h"
#include "gui/attempt/figure_text.h"
#include "gui/dashboard/band_delegate.h"
#include "gui/dashboard/event_tree.h"
#include "gui/dashboard/page_parts.h"
#include "gui/dashboard/plot_view.h"

namespace calot::gui {
namespace {

bool isWeak(const FigureStanding* standing) { return standing != nullptr && !standing->passed.value_or(true); }

}  // namespace

std::optional<double> MomentCycle::next(const analytics::FigureMoments& figure) {
  const std::vector<analytics::Moment>& moments = figure.moments;
  if (moments.empty()) return std::nullopt;
  const std::string name = figure.checkpoint + '\n' + figure.subject;
  if (name == figure_) {
    at_ = (at_ + 1) % moments.size();
  } else {
    at_ = static_cast<std::size_t>(&worstOf(moments) - moments.data());
    figure_ = name;
  }
  return std::max(0.0, moments[at_].begin - leadIn);
}

FigurePanel::FigurePanel()
    : norm_(parts::named("norm", new QComboBox)),
      verdict_(parts::plainLabel("verdict-of-norm")),
      sheet_(parts::named("grade-sheet", new QPushButton("Gr&ade sheet …"))),
      makeNorm_(parts::named("make-norm", new QPushButton("&Make one …"))),
      bars_(new PlotView("figure-bars", "Figures that count against their pass marks")),
      figureTable_(makeTree(families_, "attempt-checkpoints", "Checkpoints of the attempt, by family")),
      eventTable_(makeTree(events_, "events", "Events of the attempt, by kind")) {
  figureTable_->setItemDelegateForColumn(CheckpointTableModel::normColumn, new BandDelegate(figureTable_));
  setWidths(*figureTable_, {268, 84, 110, 130, 226, 110, 130, 460, 100, 60});
  figureTable_->setSortingEnabled(true);
  figureTable_->header()->setSortIndicatorClearable(true);
  figureTable_->header()->setSortIndicator(-1, Qt::AscendingOrder);
  setWidths(*eventTable_, {360});
  figureTable_->setMinimumHeight(8 * figureTable_->fontMetrics().height());
  auto* tabs = parts::named("figure-tabs", new QTabWidget);
  tabs->addTab(figureTable_, "&Checkpoints");
  tabs->addTab(eventTable_, "Even&ts");
  norm_->setAccessibleName("Norm that the attempt is held against");
  sheet_->setToolTip("Write one page for the trainee, with pictures of the gravest moments and all figures behind it");
  QBoxLayout* const head = parts::row({{"&Norm", norm_}, {verdict_, 1}, makeNorm_, sheet_});
  setLayout(parts::bare(parts::column({head, bars_, {tabs, 1}})));

  connect(sheet_, &QPushButton::clicked, this, &FigurePanel::sheetRequested);
  connect(makeNorm_, &QPushButton::clicked, this, &FigurePanel::normRequested);
  connect(bars_, &PlotView::attemptChosen, this, [this](const QString& key) {
    goToFigure(key.section(' ', 0, 0).toStdString(), key.section(' ', 1).toStdString());
  });
  connect(norm_, &QComboBox::currentIndexChanged, this, [this] { showStanding(); });
  const auto figureAt = [this](const QModelIndex& at) {
    if (const int row = families_.sourceRow(at); row >= 0) showFigure(row);
  };
  connect(figureTable_, &QTreeView::clicked, this, figureAt);
  for (const Qt::Key key : {Qt::Key_Return, Qt::Key_Enter})
    onKey(*figureTable_, key, [this, figureAt] { figureAt(figureTable_->currentIndex()); });
  const auto showEvent = [this](const QModelIndex& at) { emit timeChosen(at.data(eventSecondsRole).toDouble()); };
  connect(eventTable_, &QTreeView::clicked, this, showEvent);
  connect(eventTable_, &QTreeView::activated, this, showEvent);
}

void FigurePanel::setTrack(const std::vector<TrackEvent>& events, const std::vector<analytics::ErrorLine>& errors) {
  errors_ = errors;
  nextWorst_ = 0;
  listEvents(events_, events, errors);
  eventTable_->expandAll();
}

AttemptSummary FigurePanel::summary() const { return summaryOf(*attempt_, values_, grade()); }

std::vector<analytics::SheetMoment> FigurePanel::worstMoments() const {
  std::vector<analytics::FigureMoments> figures;
  for (int row = 0; row < figures_.rowCount(); ++row) {
    if (const analytics::FigureMoments* found = figures_.moments(row)) figures.push_back(*found);
  }
  return analytics::worstMoments(errors_, figures, grade());
}

const analytics::Grade* FigurePanel::grade() const {
  return standing_ && standing_->grade ? &*standing_->grade : nullptr;
}

void FigurePanel::setAttempt(std::shared_ptr<const CohortDocument> document, const analytics::AttemptRow& attempt) {
  clear();
  document_ = std::move(document);
  attempt_ = attempt;
  const QString fault = faultOf([&] {
    intervals_ = document_->database().intervals(attempt.uuid);
    values_ = document_->database().values(attempt.uuid);
  });
  if (!fault.isEmpty()) emit problem(fault);
  figures_.setValues(values_, intervals_);
  figureTable_->setColumnHidden(CheckpointTableModel::intervalColumn, intervals_.empty());
  {
    const QSignalBlocker quiet(norm_);
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
  cycle_.forget();
  values_.clear();
  intervals_.clear();
  figures_.setValues({});
  setTrack({}, {});
  {
    const QSignalBlocker quiet(norm_);
    norm_->clear();
  }
  norm_->setEnabled(false);
  verdict_->clear();
  standing_.reset();
  sheet_->setEnabled(false);
  showBars();
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
    verdict_->setText(attempt_ ? "none for this task yet" : "");
    standing_.reset();
    figures_.setStandings({});
  } else {
    standing_ = standingOf(*attempt_, values_, *norms[static_cast<std::size_t>(at)], intervals_);
    verdict_->setText(standing_->judged ? QString() : QString::fromStdString(standing_->verdict));
    figures_.setStandings(standing_->figures);
  }
  makeNorm_->setVisible(attempt_ && norms.empty());
  norm_->setVisible(!norms.empty());
  sheet_->setEnabled(attempt_.has_value());
  showBars();
  if (attempt_) emit summaryChanged();
}

void FigurePanel::showBars() {
  const std::vector<analytics::KeyFigure> figures = analytics::keyFigures(values_, grade());
  bars_->setVisible(!figures.empty());
  bars_->keepHeight(analytics::drawKeyFigures(figures, analytics::plotWidth, 1).height);
  bars_->show(
      {}, [figures](const analytics::PlotFrame& frame) { return analytics::drawKeyFigures(figures, frame.width, 1); });
}

void FigurePanel::showFigure(int row) {
  const analytics::FigureMoments* found = figures_.moments(row);
  if (found == nullptr) return;
  std::vector<std::pair<double, double>> windows;
  for (const analytics::Moment& moment : found->moments) windows.emplace_back(moment.begin, moment.end);
  emit windowsChosen(windows);
  if (const auto time = cycle_.next(*found)) emit timeChosen(*time);
}

void FigurePanel::selectFigure(int row) {
  const QModelIndex at = families_.indexOf(row);
  if (!at.isValid()) return;
  figureTable_->setCurrentIndex(at);
  figureTable_->scrollTo(at);
}

void FigurePanel::goToFigure(const std::string& checkpoint, const std::string& subject) {
  for (int row = 0; row < figures_.rowCount(); ++row) {
    const analytics::CheckpointValue& value = figures_.value(row);
    if (value.name != checkpoint || value.subject != subject) continue;
    selectFigure(row);
    if (figures_.moments(row) != nullptr)
      showFigure(row);
    else
      wanted_ = {checkpoint, subject};
    return;
  }
}

void FigurePanel::showWorst() {
  if (!errors_.empty()) {
    emit timeChosen(errors_[std::exchange(nextWorst_, (nextWorst_ + 1) % errors_.size())].time);
    return;
  }
  int chosen = -1;
  for (int row = 0; row < figures_.rowCount(); ++row) {
    const analytics::FigureMoments* found = figures_.moments(row);
    if (found == nullptr || found->moments.empty()) continue;
    const bool weak = isWeak(figures_.standing(row));
    if (chosen < 0 || weak) chosen = row;
    if (weak) break;
  }
  if (chosen < 0) return;
  selectFigure(chosen);
  showFigure(chosen);
}

}  // namespace calot::gui
