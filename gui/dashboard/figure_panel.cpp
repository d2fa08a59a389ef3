// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/figure_panel.h"

#include <algorithm>
#include <cmath>
#include <QTabWidget>

#include "analytics/assessment/norm.h"
#include "gui/attempt/figure_text.h"
#include "gui/dashboard/page_parts.h"

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
      onePage_(parts::named("one-page", new QPushButton("&One page …"))),
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
  sheet_->setToolTip("Write the attempt against this norm as a PDF");
  onePage_->setToolTip("Write the attempt on one page, with pictures of its worst moments, as a PDF");
  QBoxLayout* const head = parts::row({{"&Norm", norm_}, {verdict_, 1}, sheet_, onePage_});
  setLayout(parts::bare(parts::column({head, {tabs, 1}})));

  connect(sheet_, &QPushButton::clicked, this, [this] { emit sheetRequested(false); });
  connect(onePage_, &QPushButton::clicked, this, [this] { emit sheetRequested(true); });
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
  listEvents(events_, events, errors);
  eventTable_->expandAll();
}

AttemptSummary FigurePanel::summary() const {
  return summaryOf(*attempt_, values_, standing_ && standing_->grade ? &*standing_->grade : nullptr);
}

std::vector<WorstMoment> FigurePanel::worstMoments() const {
  constexpr double apart = 1.0;  // s: two pictures of one moment tell no more than one
  std::vector<WorstMoment> worst;
  for (const analytics::ErrorLine& error : errors_) {
    if (error.severity == Severity::minor || worst.size() == maxWorstMoments) break;
    worst.push_back({error.time, std::string(analytics::nameOf(error.severity)) + ": " + error.counted()});
  }
  enum class Tier { weak, counts, any };
  for (const Tier tier : {Tier::weak, Tier::counts, Tier::any}) {
    for (int row = 0; row < figures_.rowCount() && worst.size() < maxWorstMoments; ++row) {
      const analytics::FigureMoments* found = figures_.moments(row);
      const analytics::CheckpointValue& value = figures_.value(row);
      if (found == nullptr || found->moments.empty()) continue;
      if (tier == Tier::weak && !isWeak(figures_.standing(row))) continue;
      if (tier == Tier::counts && !analytics::countsByDefault(value.name)) continue;
      const analytics::Moment& most = worstOf(found->moments);
      const double time = 0.5 * (most.begin + most.end);
      if (std::any_of(worst.begin(), worst.end(),
                      [&](const WorstMoment& w) { return std::abs(w.time - time) < apart; }))
        continue;
      worst.push_back({time, figureTitle(value.name, value.subject).toStdString()});
    }
  }
  std::sort(worst.begin(), worst.end(), [](const WorstMoment& a, const WorstMoment& b) { return a.time < b.time; });
  return worst;
}

const analytics::Norm* FigurePanel::norm() const {
  return standing_ && standing_->grade ? &standing_->grade->norm : nullptr;
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
  figureTable_->expandAll();
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
  onePage_->setEnabled(false);
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
    verdict_->setText("No norm for this task yet (calot norm create).");
    standing_.reset();
    figures_.setStandings({});
  } else {
    standing_ = standingOf(*attempt_, values_, *norms[static_cast<std::size_t>(at)], intervals_);
    verdict_->setText(standing_->judged ? QString() : QString::fromStdString(standing_->verdict));
    figures_.setStandings(standing_->figures);
  }
  sheet_->setEnabled(norm() != nullptr);
  onePage_->setEnabled(attempt_.has_value());
  if (attempt_) emit summaryChanged();
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
