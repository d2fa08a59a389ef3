// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/checkpoint_table_model.h"

#include <algorithm>
#include <cmath>
#include <QFont>
#include <QLocale>
#include <utility>

#include "analytics/report/key_figures.h"
#include "gui/attempt/widget_parts.h"
#include "gui/words/attempt_summary.h"

namespace calot::gui {
namespace {

QString momentText(const analytics::Moment& moment) {
  return QString("%1 (%2 %)")
      .arg(QString::fromStdString(timeText(moment.begin)), QLocale().toString(std::lround(100.0 * moment.share)));
}

double factorOf(const analytics::CheckpointValue& value) {
  const analytics::CheckpointDefinition* const definition = analytics::definitionOf(value);
  return definition != nullptr ? definition->displayFactor : 1.0;
}

QString intervalText(const analytics::ValueInterval& interval, double factor) {
  if (!interval.lower) return "not known";
  if (*interval.lower == *interval.upper) return "exact";
  return QString::fromUtf8("%1 to %2").arg(numberText(*interval.lower * factor), numberText(*interval.upper * factor));
}

QString intervalToolTip(const analytics::ValueInterval& interval, double factor) {
  if (!interval.lower) return "No interval: " + QString::fromStdString(interval.reason) + ".";
  if (*interval.lower == *interval.upper)
    return "The same in smaller steps, with a finer mesh and with other assumed constants.";
  return QString(
             "Where the value may lie for an exact simulation with the right constants.\nIn steps of length zero: "
             "%1; with elements of size zero: %2 (changes, extrapolated)\nSpread by assumed constants: %3")
      .arg(numberText(interval.stepEffect * factor), numberText(interval.meshEffect * factor),
           numberText(interval.constantsSpread * factor));
}

QString standingText(const FigureStanding& standing) {
  QString text;
  if (standing.passed) text = *standing.passed ? QString::fromUtf8("✓ passes") : QString::fromUtf8("▼ falls short");
  if (standing.undecided) text += QString::fromUtf8(" (undecided)");
  if (standing.percentile) text += QString(text.isEmpty() ? "P %1" : ", P %1").arg(std::lround(*standing.percentile));
  return text;
}

}  // namespace

const analytics::Moment& worstOf(const std::vector<analytics::Moment>& moments) {
  return *std::max_element(moments.begin(), moments.end(),
                           [](const analytics::Moment& a, const analytics::Moment& b) { return a.share < b.share; });
}

void CheckpointTableModel::setValues(std::vector<analytics::CheckpointValue> values,
                                     std::vector<analytics::ValueInterval> intervals) {
  beginResetModel();
  values_ = std::move(values);
  intervals_ = std::move(intervals);
  standings_.clear();
  moments_.clear();
  momentsText_.clear();
  endResetModel();
}

void CheckpointTableModel::setStandings(std::vector<FigureStanding> standings) {
  standings_ = std::move(standings);
  if (rowCount() > 0) emit dataChanged(index(0, normColumn), index(rowCount() - 1, normColumn));
}

void CheckpointTableModel::setMoments(std::vector<analytics::FigureMoments> moments) {
  moments_ = std::move(moments);
  if (rowCount() > 0) emit dataChanged(index(0, momentColumn), index(rowCount() - 1, momentColumn));
}

void CheckpointTableModel::setMomentsText(const QString& text) {
  momentsText_ = text;
  setMoments({});
}

const FigureStanding* CheckpointTableModel::standing(int row) const { return entryOf(standings_, value(row)); }
const analytics::FigureMoments* CheckpointTableModel::moments(int row) const { return entryOf(moments_, value(row)); }

const analytics::ValueInterval* CheckpointTableModel::interval(int row) const {
  return analytics::findInterval(intervals_, value(row));
}

int CheckpointTableModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(values_.size());
}
int CheckpointTableModel::columnCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : columnTotal; }

QString CheckpointTableModel::text(int row, int column) const {
  const analytics::CheckpointValue& shown = value(row);
  const analytics::CheckpointDefinition* const definition = analytics::definitionOf(shown);
  switch (column) {
    case nameColumn:
      return shown.metric ? QString::fromStdString(shown.metric->definition.title) + " (external)"
                          : figureTitle(shown.name, {});
    case subjectColumn:
      return shown.subject.empty() ? QStringLiteral("attempt") : QString::fromStdString(shown.subject);
    case valueColumn:
      return valueText(shown) + (shown.note.empty() ? "" : " *");
    case intervalColumn:
      return interval(row) != nullptr ? intervalText(*interval(row), factorOf(shown)) : QString();
    case normColumn:
      return standing(row) != nullptr ? standingText(*standing(row)) : QString();
    case momentColumn:
      if (const analytics::FigureMoments* found = moments(row); found != nullptr && !found->moments.empty())
        return momentText(worstOf(found->moments));
      return moments_.empty() ? momentsText_ : QString();
    case directionColumn:
      return directionText(shown);
    case windowColumn:
      return definition != nullptr ? QString::fromStdString(definition->window) : QString();
    case originColumn:
      return originText(shown.origin);
    case versionColumn:
      return QString::number(shown.version);
    default:
      return {};
  }
}

QString CheckpointTableModel::toolTip(int row, int column) const {
  const analytics::CheckpointValue& shown = value(row);
  if (const FigureStanding* place = standing(row); column == normColumn && place != nullptr) {
    QString tip = QString::fromStdString(place->explanation).trimmed();
    const auto number = [of = analytics::definitionOf(shown)](double value) { return numberText(value, of); };
    if (place->cut) tip += QString("\nPass mark: %1").arg(number(*place->cut));
    if (place->band)
      tip += QString("\nCompetent members: a tenth below %1, half between %2 and %3, median %4, a tenth above %5")
                 .arg(number(place->band->p10), number(place->band->p25), number(place->band->p75),
                      number(place->band->p50), number(place->band->p90));
    return tip;
  }
  if (const analytics::ValueInterval* found = interval(row); column == intervalColumn && found != nullptr)
    return intervalToolTip(*found, factorOf(shown));
  if (const analytics::FigureMoments* found = moments(row); column == momentColumn && found != nullptr) {
    if (found->moments.empty()) return QString::fromStdString(found->none);
    QStringList lines{"Most of it came about here; each click goes to the next:"};
    for (const analytics::Moment& moment : found->moments) lines += momentText(moment);
    return lines.join('\n');
  }
  const analytics::CheckpointDefinition* const definition = analytics::definitionOf(shown);
  QString tip = QString::fromStdString(shown.name);
  if (definition != nullptr) tip += ": " + QString::fromStdString(definition->definition);
  if (!shown.filter.empty()) tip += "\nFilter: " + QString::fromStdString(shown.filter);
  if (!shown.note.empty()) tip += "\n* " + QString::fromStdString(shown.note);
  return tip;
}

QVariant CheckpointTableModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid() || index.row() >= rowCount()) return {};
  const int row = index.row(), column = index.column();
  const bool missing = !value(row).value.has_value();
  switch (role) {
    case Qt::DisplayRole:
      return text(row, column);
    case Qt::ToolTipRole:
      return toolTip(row, column);
    case Qt::TextAlignmentRole:
      if (column == intervalColumn) return QVariant::fromValue(Qt::Alignment(Qt::AlignVCenter | Qt::AlignRight));
      if (column == valueColumn)
        return QVariant::fromValue(Qt::Alignment(Qt::AlignVCenter | (missing ? Qt::AlignLeft : Qt::AlignRight)));
      return {};
    case Qt::ForegroundRole:
      if (column == valueColumn && missing) return theme::muted();
      return {};
    case standingRole:
      return column == normColumn ? QVariant::fromValue(static_cast<const void*>(standing(row))) : QVariant();
    default:
      return {};
  }
}

QVariant CheckpointTableModel::headerData(int section, Qt::Orientation orientation, int role) const {
  static constexpr const char* titles[columnTotal] = {"Checkpoint",  "Of",           "Value",     "Simulation",
                                                      "In the norm", "Worst moment", "Direction", "Window",
                                                      "Origin",      "Version"};
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole || section < 0 || section >= columnTotal) return {};
  return QString(titles[section]);
}

}  // namespace calot::gui
