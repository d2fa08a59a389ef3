// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/checkpoint_table_model.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <QApplication>
#include <QFont>
#include <QLocale>
#include <QPainter>
#include <QStyle>
#include <utility>

#include "analytics/report/key_figures.h"
#include "gui/attempt/widget_parts.h"
#include "gui/words/attempt_summary.h"
#include "gui/words/event_words.h"

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

constexpr int barWidth = 120;

void paintBand(QPainter& painter, const QRectF& box, const FigureStanding& standing) {
  const FigureStanding::Band& band = *standing.band;
  double low = band.p10, high = band.p90;
  for (const auto& number : {standing.value, standing.cut}) {
    if (!number) continue;
    low = std::min(low, *number);
    high = std::max(high, *number);
  }
  const double room = high > low ? 0.06 * (high - low) : 1.0;
  low -= room;
  high += room;
  const auto x = [&](double number) { return box.left() + (number - low) / (high - low) * box.width(); };
  const double middle = box.center().y();
  const auto bar = [&](double from, double to, double half, const QColor& colour) {
    painter.fillRect(QRectF(x(from), middle - half, std::max(1.0, x(to) - x(from)), 2.0 * half), colour);
  };
  bar(band.p10, band.p90, 3.0, theme::dark() ? QColor(0x2a, 0x4a, 0x60) : QColor(0xbf, 0xd9, 0xea));
  bar(band.p25, band.p75, 5.0, theme::dark() ? QColor(0x3c, 0x70, 0x94) : QColor(0x7f, 0xb4, 0xd6));
  painter.setPen(QPen(theme::text(), 1.5));
  painter.drawLine(QPointF(x(band.p50), middle - 6.0), QPointF(x(band.p50), middle + 6.0));
  if (standing.cut) {
    painter.setPen(QPen(theme::text(), 1.0, Qt::DashLine));
    painter.drawLine(QPointF(x(*standing.cut), box.top() + 1.0), QPointF(x(*standing.cut), box.bottom() - 1.0));
  }
  if (standing.value) {
    const double at = x(*standing.value);
    painter.setPen(QPen(theme::surface(), 1.0));
    painter.setBrush(standing.passed.value_or(true) ? theme::first() : theme::second());
    painter.drawPolygon(QPolygonF{
        {QPointF(at - 5.0, middle), QPointF(at, middle - 6.0), QPointF(at + 5.0, middle), QPointF(at, middle + 6.0)}});
  }
}

/// Families in the order of tables, external metrics behind them.
int rankOf(const analytics::CheckpointValue& value) {
  const auto family = analytics::familyOf(value.name);
  constexpr int afterAll = 1000;
  return family && !value.metric ? static_cast<int>(*family) : afterAll;
}

QString familyTitle(const analytics::CheckpointValue& value) {
  const auto family = analytics::familyOf(value.name);
  QString title = family && !value.metric ? QString::fromStdString(analytics::nameOf(*family)) : "own metrics";
  title[0] = title[0].toUpper();
  return title;
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

void BandDelegate::paint(QPainter* painter, const QStyleOptionViewItem& option, const QModelIndex& index) const {
  const auto* standing =
      static_cast<const FigureStanding*>(index.data(CheckpointTableModel::standingRole).value<const void*>());
  if (standing == nullptr || !standing->band) {
    QStyledItemDelegate::paint(painter, option, index);
    return;
  }
  QStyleOptionViewItem item = option;
  initStyleOption(&item, index);
  const QString text = std::exchange(item.text, QString());
  const QStyle* style = option.widget != nullptr ? option.widget->style() : QApplication::style();
  style->drawControl(QStyle::CE_ItemViewItem, &item, painter, option.widget);
  painter->save();
  painter->setRenderHint(QPainter::Antialiasing);
  paintBand(*painter, QRectF(option.rect.left() + 4, option.rect.top(), barWidth, option.rect.height()), *standing);
  const bool selected = option.state.testFlag(QStyle::State_Selected);
  painter->setPen(option.palette.color(selected ? QPalette::HighlightedText : QPalette::Text));
  painter->drawText(option.rect.adjusted(barWidth + 12, 0, -4, 0), Qt::AlignVCenter | Qt::AlignLeft, text);
  painter->restore();
}

void listEvents(QStandardItemModel& tree, const std::vector<TrackEvent>& events,
                const std::vector<analytics::ErrorLine>& errors) {
  tree.setHorizontalHeaderLabels({"Event", "Time"});
  tree.removeRows(0, tree.rowCount());
  const auto rowOf = [](const QString& text, double time, bool marked) {
    auto* first = new QStandardItem(text);
    auto* second = new QStandardItem(QString::fromStdString(timeText(time)));
    for (QStandardItem* item : {first, second}) {
      item->setEditable(false);
      item->setData(time, eventSecondsRole);
      if (marked) item->setToolTip("Something that should not happen");
    }
    return QList<QStandardItem*>{first, second};
  };
  const auto addGroup = [&](const QString& text, double time, bool marked, const std::vector<const TrackEvent*>& of) {
    const QList<QStandardItem*> head = rowOf(marked ? QString::fromUtf8("▲ ") + text : text, time, marked);
    QFont bold = head[0]->font();
    bold.setBold(true);
    head[0]->setFont(bold);
    for (const TrackEvent* event : of)
      head[0]->appendRow(rowOf(QString::fromStdString(event->text), event->time, marked));
    tree.appendRow(head);
  };
  for (const analytics::ErrorLine& error : errors) {
    std::vector<const TrackEvent*> occasions;
    for (const TrackEvent& event : events) {
      if (error.count > 1 && event.severity && event.title == error.text) occasions.push_back(&event);
    }
    QString severity = analytics::nameOf(error.severity);
    severity[0] = severity[0].toUpper();
    addGroup(severity + ": " + QString::fromStdString(error.counted()), error.time, true, occasions);
  }
  std::vector<std::vector<const TrackEvent*>> groups;
  for (const TrackEvent& event : events) {
    if (event.severity) continue;
    const auto at = std::find_if(groups.begin(), groups.end(),
                                 [&](const auto& group) { return group.front()->title == event.title; });
    if (at == groups.end())
      groups.push_back({&event});
    else
      at->push_back(&event);
  }
  std::stable_partition(groups.begin(), groups.end(), [](const auto& group) { return group.front()->error; });
  for (const auto& group : groups) {
    const TrackEvent& first = *group.front();
    QString title = QString::fromStdString(first.title);
    title[0] = title[0].toUpper();
    addGroup(QString("%1 (%2)").arg(title).arg(group.size()), first.time, first.error, group);
  }
}

/// A family with its rank, or one of its checkpoints with its row in the source.
class FamilyTreeModel::Entry : public QStandardItem {
 public:
  explicit Entry(int place) : place_(place) {}
  [[nodiscard]] int place() const { return place_; }
  bool operator<(const QStandardItem& other) const override {
    const int place = static_cast<const Entry&>(other).place_;
    return parent() == nullptr ? place_ < place : static_cast<const FamilyTreeModel*>(model())->isBefore(place_, place);
  }

 private:
  int place_;
};

FamilyTreeModel::FamilyTreeModel(const CheckpointTableModel& source)
    : QStandardItemModel(0, CheckpointTableModel::columnTotal), source_(source) {
  connect(&source_, &QAbstractItemModel::modelReset, this, &FamilyTreeModel::fill);
  connect(&source_, &QAbstractItemModel::dataChanged, this, [this](const QModelIndex& first, const QModelIndex& last) {
    for (int f = 0; f < rowCount(); ++f) {
      const QModelIndex family = index(f, 0);
      emit dataChanged(index(0, first.column(), family), index(rowCount(family) - 1, last.column(), family));
    }
  });
  fill();
}

void FamilyTreeModel::fill() {
  removeRows(0, rowCount());
  leftOut_ = 0;
  std::map<int, Entry*> families;  // by rank
  for (int row = 0; row < source_.rowCount(); ++row) {
    const analytics::CheckpointValue& value = source_.value(row);
    if (analytics::sceneLacks(value)) {
      ++leftOut_;
      continue;
    }
    Entry*& family = families[rankOf(value)];
    if (family == nullptr) {
      family = new Entry(rankOf(value));
      family->setColumnCount(CheckpointTableModel::columnTotal);
      QFont bold;
      bold.setBold(true);
      family->setFont(bold);
    }
    family->appendRow(new Entry(row));
    family->setText(QString("%1 (%2)").arg(familyTitle(value)).arg(family->rowCount()));
  }
  for (const auto& [rank, family] : families) appendRow(family);
  sort(sortColumn_, sortOrder_);
}

void FamilyTreeModel::sort(int column, Qt::SortOrder order) {
  sortColumn_ = column;
  sortOrder_ = order;
  QStandardItemModel::sort(0);  // by isBefore()
}

bool FamilyTreeModel::isBefore(int a, int b) const {
  if (sortColumn_ < 0) return a < b;
  const analytics::CheckpointValue &first = source_.value(a), &second = source_.value(b);
  const auto inOrder = [this](const auto& x, const auto& y) {
    return sortOrder_ == Qt::AscendingOrder ? x < y : y < x;
  };
  if (sortColumn_ == CheckpointTableModel::valueColumn) {
    if (!first.value || !second.value) return first.value && !second.value;
    return inOrder(displayedValue(first).number, displayedValue(second).number);
  }
  if (sortColumn_ == CheckpointTableModel::normColumn) {
    const auto rank = [this](int row) {
      const FigureStanding* standing = source_.standing(row);
      return standing != nullptr ? standing->percentile.value_or(1000.0) : 1000.0;
    };
    return inOrder(rank(a), rank(b));
  }
  const auto text = [this](int row) { return source_.index(row, sortColumn_).data().toString(); };
  return inOrder(text(a).localeAwareCompare(text(b)), 0);
}

int FamilyTreeModel::sourceRow(const QModelIndex& index) const {
  if (!index.parent().isValid()) return -1;
  return static_cast<const Entry*>(itemFromIndex(index.siblingAtColumn(0)))->place();
}

QModelIndex FamilyTreeModel::indexOf(int sourceRow) const {
  for (int f = 0; f < rowCount(); ++f) {
    const QModelIndex family = index(f, 0);
    for (int row = 0; row < rowCount(family); ++row) {
      if (this->sourceRow(index(row, 0, family)) == sourceRow) return index(row, 0, family);
    }
  }
  return {};
}

QVariant FamilyTreeModel::data(const QModelIndex& index, int role) const {
  const int row = sourceRow(index);
  return row < 0 ? QStandardItemModel::data(index, role) : source_.index(row, index.column()).data(role);
}

QVariant FamilyTreeModel::headerData(int section, Qt::Orientation orientation, int role) const {
  return source_.headerData(section, orientation, role);
}

}  // namespace calot::gui
