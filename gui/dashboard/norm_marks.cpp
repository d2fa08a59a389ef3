// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/norm_marks.h"

#include <algorithm>
#include <QCheckBox>
#include <QLabel>
#include <QSignalBlocker>
#include <QVBoxLayout>

#include "analytics/assessment/verdict.h"
#include "analytics/report/figure_number.h"
#include "gui/attempt/figure_text.h"
#include "gui/attempt/widget_parts.h"
#include "gui/dashboard/mark_slider.h"

namespace calot::gui {
namespace {

double factorOf(const analytics::NormCheckpoint& mark) {
  const analytics::CheckpointDefinition* const definition = analytics::definitionOf(mark);
  return definition == nullptr ? 1.0 : definition->displayFactor;
}

/// Counts are whole; other figures are not, though some of their values may be.
bool isCount(const analytics::NormCheckpoint& mark, const std::vector<MarkSlider::Dot>& dots) {
  const analytics::CheckpointDefinition* const definition = analytics::definitionOf(mark);
  return std::ranges::all_of(dots, [&](const auto& dot) { return analytics::isWrittenWhole(definition, dot.value); });
}

/// A mark that all competent members pass: the worst of their values.
double worstOf(const std::vector<MarkSlider::Dot>& dots, bool lowerIsBetter) {
  std::optional<double> worst;
  for (const MarkSlider::Dot& dot : dots) {
    if (!dot.competent) continue;
    if (!worst || (lowerIsBetter ? dot.value > *worst : dot.value < *worst)) worst = dot.value;
  }
  return worst.value_or(0.0);
}

}  // namespace

NormMark::NormMark(const analytics::NormCheckpoint& mark, const std::string& figure)
    : figure_(figure),
      mark_(mark),
      always_(mark.checkpoint == analytics::criticalErrors),
      byDefault_(always_ || analytics::countsByDefault(mark.checkpoint)),
      value_(parts::plainLabel("mark-value", false)),
      reason_(parts::plainLabel("mark-reason")),
      counting_(parts::named("mark-counts", new QCheckBox("counts"))),
      veto_(parts::named("mark-veto", new QCheckBox("veto"))) {
  setObjectName("mark-" + QString::fromStdString(figure));
  const QString title = figureTitle(mark.checkpoint, mark.subject);
  auto* const name = parts::plainLabel("mark-title");
  name->setText(title);
  parts::embolden(name);
  slider_ = new MarkSlider("mark-slider", "Pass mark: " + title);
  counting_->setAccessibleName(title + " counts");
  veto_->setAccessibleName(title + " is a veto, by a mark of your own");
  counting_->setToolTip("The figure is in the rule");
  veto_->setToolTip("A mark of your own: who misses it fails, however many other figures are passed");
  for (QCheckBox* box : {counting_, veto_}) {
    box->setChecked(always_);
    box->setEnabled(!always_);
  }
  slider_->setEnabled(!always_);
  auto* const column = parts::column({parts::row({{name, 1}, value_, counting_, veto_}), slider_, reason_});
  column->setContentsMargins(0, 0, 0, theme::inType(6));
  column->setSpacing(2);
  setLayout(column);
  connect(slider_, &QSlider::valueChanged, this, [this] { fix(slider_->markedValue()); });
  connect(veto_, &QCheckBox::clicked, this, [this](bool on) {
    fix(on ? std::optional(slider_->view().mark ? *slider_->view().mark : slider_->markedValue()) : std::nullopt);
  });
  connect(counting_, &QCheckBox::clicked, this, [this](bool on) {
    counts_ = on;
    if (on && !hasMark_) return fix(slider_->markedValue());  // a mark that nobody else sets
    if (!on) fixed_.reset();
    emit changed();
  });
}

void NormMark::tabAfter(NormMark& before) {
  setTabOrder(before.slider_, counting_);
  setTabOrder(counting_, veto_);
  setTabOrder(veto_, slider_);
}

bool NormMark::isWanted() const { return !always_ && counts_.value_or(byDefault_); }

std::optional<analytics::FixedCut> NormMark::fixed() const {
  if (!fixed_ || !isWanted()) return std::nullopt;
  return analytics::FixedCut{figure_, mark_.direction == analytics::Direction::higher, *fixed_};
}

void NormMark::fix(std::optional<double> mark) {
  fixed_ = mark;
  if (mark) counts_ = true;
  MarkSlider::View view = slider_->view();
  view.mark = mark ? mark : computed_;
  view.before = mark ? computed_ : std::nullopt;
  hasMark_ = view.mark.has_value();
  slider_->show(std::move(view));
  describe();
  emit changed();
}

void NormMark::show(const analytics::NormTrial& trial, std::size_t position) {
  mark_ = trial.norm.checkpoints[position];
  const double factor = factorOf(mark_);
  MarkSlider::View view;
  for (const analytics::NormMember& member : trial.norm.members) {
    if (member.values[position]) view.dots.push_back({*member.values[position] * factor, member.competent});
  }
  view.lowerIsBetter = mark_.direction == analytics::Direction::lower;
  view.whole = isCount(mark_, view.dots);
  computed_.reset();
  if (trial.computed[position]) computed_ = *trial.computed[position] * factor;
  view.start = always_ ? 0.0 : worstOf(view.dots, view.lowerIsBetter);
  view.mark = always_ ? std::optional(0.0) : fixed_ ? fixed_ : computed_;
  if (fixed_) view.before = computed_;
  hasMark_ = view.mark.has_value();
  slider_->show(std::move(view));
  describe();
}

void NormMark::describe() {
  const MarkSlider::View& view = slider_->view();
  const analytics::CheckpointDefinition* const definition = analytics::definitionOf(mark_);
  const QString unit = definition == nullptr || definition->displayUnit == "1"
                           ? QString()
                           : ' ' + QString::fromStdString(definition->displayUnit);
  const QString bound = view.lowerIsBetter ? "at most " : "at least ";
  QString text = view.mark ? bound + numberText(*view.mark, view.whole ? definition : nullptr) + unit : "no mark";
  if (fixed_) text += ", set by hand";
  value_->setText(text);
  slider_->setAccessibleDescription(text);
  parts::say(reason_, always_      ? "One fails an attempt, whatever its other figures."
                      : view.mark  ? QString()
                      : isWanted() ? "Does not count: " + QString::fromStdString(mark_.reason) +
                                         ". Move the line to set a mark by hand."
                                   : "The members give no mark: " + QString::fromStdString(mark_.reason) + '.');
  const QSignalBlocker quietCounting(counting_), quietVeto(veto_);
  if (always_) return;
  counting_->setChecked(isWanted() && hasMark_);
  veto_->setChecked(fixed_.has_value());
}

NormMarks::NormMarks() : column_(new QVBoxLayout) {
  parts::bare(column_);
  column_->addStretch(1);
  setLayout(column_);
}

void NormMarks::show(const analytics::NormTrial& trial) {
  const std::vector<analytics::NormCheckpoint>& marks = trial.norm.checkpoints;
  std::map<std::string, NormMark*> rows;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const std::string figure = analytics::figureName(marks[i].checkpoint, marks[i].subject);
    NormMark*& row = rows[figure];
    if (const auto known = rows_.find(figure); known != rows_.end()) {
      row = known->second;
      rows_.erase(known);
    } else {
      row = new NormMark(marks[i], figure);
      connect(row, &NormMark::changed, this, &NormMarks::changed);
    }
    row->show(trial, i);
  }
  for (const auto& gone : rows_) delete gone.second;
  rows_ = std::move(rows);
  // Critical errors, then what counts by itself, harm first, then the others by the order of the sheet.
  const auto rank = [](const analytics::NormCheckpoint& mark) {
    const auto& all = analytics::countingCheckpoints();
    if (mark.checkpoint == analytics::criticalErrors) return std::ptrdiff_t{-1};
    return std::ranges::find(all, mark.checkpoint) - all.begin();
  };
  std::vector<const analytics::NormCheckpoint*> order;
  for (const analytics::NormCheckpoint& mark : marks) order.push_back(&mark);
  std::ranges::stable_sort(order, {}, [&](const analytics::NormCheckpoint* mark) { return rank(*mark); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    NormMark* const row = rows_.at(analytics::figureName(order[i]->checkpoint, order[i]->subject));
    if (column_->indexOf(row) != static_cast<int>(i)) {
      column_->removeWidget(row);
      column_->insertWidget(static_cast<int>(i), row);
    }
  }
  for (std::size_t i = 1; i < order.size(); ++i)
    rows_.at(analytics::figureName(order[i]->checkpoint, order[i]->subject))
        ->tabAfter(*rows_.at(analytics::figureName(order[i - 1]->checkpoint, order[i - 1]->subject)));
  showAll(all_);
}

void NormMarks::showAll(bool all) {
  all_ = all;
  for (const auto& [figure, row] : rows_) row->setVisible(all || row->countsByItself() || row->isDecided());
}

std::vector<std::string> NormMarks::wanted() const {
  std::vector<std::string> names;
  for (const auto& [figure, row] : rows_) {
    if (row->isWanted()) names.push_back(figure);
  }
  return names;
}

std::vector<std::string> NormMarks::counting() const {
  std::vector<std::string> names;
  for (const auto& [figure, row] : rows_) {
    if (row->counts()) names.push_back(figure);
  }
  return names;
}

std::vector<analytics::FixedCut> NormMarks::fixed() const {
  std::vector<analytics::FixedCut> cuts;
  for (const auto& [figure, row] : rows_) {
    if (const auto cut = row->fixed()) cuts.push_back(*cut);
  }
  return cuts;
}

}  // namespace calot::gui
