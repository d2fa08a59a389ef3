// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/tree_models.h"

#include <algorithm>
#include <map>
#include <QFont>

#include "analytics/assessment/grade.h"
#include "analytics/checkpoints/checkpoint.h"
#include "gui/attempt/figure_text.h"
#include "gui/attempt/theme.h"
#include "gui/words/event_words.h"

namespace calot::gui {
namespace {

QList<QStandardItem*> line(const QString& what, const QString& time, const TrackEvent& event) {
  auto* first = new QStandardItem(what);
  auto* second = new QStandardItem(time);
  for (QStandardItem* item : {first, second}) {
    item->setEditable(false);
    item->setData(event.time, EventTreeModel::secondsRole);
    if (event.error) item->setToolTip("Something that should not happen");
  }
  return {first, second};
}

}  // namespace

EventTreeModel::EventTreeModel(QObject* parent) : QStandardItemModel(parent) {
  setHorizontalHeaderLabels({"Event", "Time"});
}

void EventTreeModel::setEvents(const std::vector<TrackEvent>& events) {
  clear();
  setHorizontalHeaderLabels({"Event", "Time"});
  std::vector<std::vector<const TrackEvent*>> groups;
  for (const TrackEvent& event : events) {
    const auto at = std::find_if(groups.begin(), groups.end(),
                                 [&](const auto& group) { return group.front()->kind == event.kind; });
    if (at == groups.end())
      groups.push_back({&event});
    else
      at->push_back(&event);
  }
  std::stable_partition(groups.begin(), groups.end(), [](const auto& group) { return group.front()->error; });
  for (const auto& group : groups) {
    const TrackEvent& first = *group.front();
    const EventWords* words = wordsOf(first.kind);
    QString title = words != nullptr ? QString::fromUtf8(words->phrase) : QString::fromStdString(first.text);
    title[0] = title[0].toUpper();
    QList<QStandardItem*> head =
        line(QString::fromUtf8(first.error ? "▲ %1 (%2)" : "%1 (%2)").arg(title).arg(group.size()),
             QString::fromStdString(timeText(first.time)), first);
    QFont bold = head[0]->font();
    bold.setBold(true);
    head[0]->setFont(bold);
    for (const TrackEvent* event : group)
      head[0]->appendRow(
          line(QString::fromStdString(event->text), QString::fromStdString(timeText(event->time)), *event));
    appendRow(head);
  }
}

namespace {

constexpr quintptr familyId = 0;  // of families; an entry's is its family's row + 1

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

FamilyTreeModel::FamilyTreeModel(CheckpointTableModel& source, QObject* parent)
    : QAbstractItemModel(parent), source_(source) {
  connect(&source_, &QAbstractItemModel::modelAboutToBeReset, this, [this] { beginResetModel(); });
  connect(&source_, &QAbstractItemModel::modelReset, this, [this] {
    group();
    endResetModel();
  });
  connect(&source_, &QAbstractItemModel::dataChanged, this, [this](const QModelIndex& first, const QModelIndex& last) {
    for (int f = 0; f < rowCount(); ++f) {
      const QModelIndex family = index(f, 0);
      if (rowCount(family) > 0)
        emit dataChanged(index(0, first.column(), family), index(rowCount(family) - 1, last.column(), family));
    }
  });
  group();
}

void FamilyTreeModel::group() {
  families_.clear();
  leftOut_ = 0;
  std::map<int, Family> byRank;
  for (int row = 0; row < source_.rowCount(); ++row) {
    const analytics::CheckpointValue& value = source_.value(row);
    if (analytics::sceneLacks(value)) {
      ++leftOut_;
      continue;
    }
    Family& family = byRank[rankOf(value)];
    if (family.title.isEmpty()) family.title = familyTitle(value);
    family.rows.push_back(row);
  }
  for (auto& entry : byRank) families_.push_back(std::move(entry.second));
  order();
}

void FamilyTreeModel::order() {
  for (Family& family : families_) {
    std::sort(family.rows.begin(), family.rows.end());
    if (sortColumn_ < 0) continue;
    const auto before = [this](int a, int b) {
      const analytics::CheckpointValue &first = source_.value(a), &second = source_.value(b);
      if (sortColumn_ == CheckpointTableModel::valueColumn) {
        if (first.value.has_value() != second.value.has_value()) return first.value.has_value();
        if (!first.value) return a < b;
        const double x = displayedValue(first).number, y = displayedValue(second).number;
        return sortOrder_ == Qt::AscendingOrder ? x < y : y < x;
      }
      if (sortColumn_ == CheckpointTableModel::normColumn) {
        const auto rank = [this](int row) {
          const FigureStanding* standing = source_.standing(row);
          return standing != nullptr && standing->percentile ? *standing->percentile : 1000.0;
        };
        return sortOrder_ == Qt::AscendingOrder ? rank(a) < rank(b) : rank(b) < rank(a);
      }
      const QString x = source_.index(a, sortColumn_).data(Qt::DisplayRole).toString();
      const QString y = source_.index(b, sortColumn_).data(Qt::DisplayRole).toString();
      const int compared = x.localeAwareCompare(y);
      return sortOrder_ == Qt::AscendingOrder ? compared < 0 : compared > 0;
    };
    std::stable_sort(family.rows.begin(), family.rows.end(), before);
  }
}

void FamilyTreeModel::sort(int column, Qt::SortOrder order) {
  emit layoutAboutToBeChanged();
  const QModelIndexList before = persistentIndexList();
  std::vector<int> rows;
  for (const QModelIndex& index : before) rows.push_back(sourceRow(index));
  sortColumn_ = column;
  sortOrder_ = order;
  this->order();
  QModelIndexList after;
  for (qsizetype i = 0; i < before.size(); ++i) {
    const int row = rows[static_cast<std::size_t>(i)];
    after += row < 0 ? before[i] : indexOf(row, before[i].column());
  }
  changePersistentIndexList(before, after);
  emit layoutChanged();
}

int FamilyTreeModel::sourceRow(const QModelIndex& index) const {
  if (!index.isValid() || index.internalId() == familyId) return -1;
  return families_[static_cast<std::size_t>(index.internalId() - 1)].rows[static_cast<std::size_t>(index.row())];
}

QModelIndex FamilyTreeModel::indexOf(int sourceRow, int column) const {
  for (std::size_t f = 0; f < families_.size(); ++f) {
    const std::vector<int>& rows = families_[f].rows;
    const auto at = std::find(rows.begin(), rows.end(), sourceRow);
    if (at != rows.end()) return createIndex(static_cast<int>(at - rows.begin()), column, quintptr{f + 1});
  }
  return {};
}

QModelIndex FamilyTreeModel::index(int row, int column, const QModelIndex& parent) const {
  if (!hasIndex(row, column, parent)) return {};
  return createIndex(row, column, parent.isValid() ? static_cast<quintptr>(parent.row()) + 1 : familyId);
}

QModelIndex FamilyTreeModel::parent(const QModelIndex& child) const {
  if (!child.isValid() || child.internalId() == familyId) return {};
  return createIndex(static_cast<int>(child.internalId() - 1), 0, familyId);
}

int FamilyTreeModel::rowCount(const QModelIndex& parent) const {
  if (!parent.isValid()) return static_cast<int>(families_.size());
  if (parent.internalId() != familyId || parent.column() != 0) return 0;
  return static_cast<int>(families_[static_cast<std::size_t>(parent.row())].rows.size());
}

int FamilyTreeModel::columnCount(const QModelIndex& /*parent*/) const { return CheckpointTableModel::columnTotal; }

QVariant FamilyTreeModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  if (const int row = sourceRow(index); row >= 0) return source_.data(source_.index(row, index.column()), role);
  const Family& family = families_[static_cast<std::size_t>(index.row())];
  if (role == Qt::DisplayRole && index.column() == 0)
    return QString("%1 (%2)").arg(family.title).arg(family.rows.size());
  if (role == Qt::FontRole) {
    QFont bold;
    bold.setBold(true);
    return bold;
  }
  return {};
}

QVariant FamilyTreeModel::headerData(int section, Qt::Orientation orientation, int role) const {
  return source_.headerData(section, orientation, role);
}

Qt::ItemFlags FamilyTreeModel::flags(const QModelIndex& index) const {
  return index.isValid() ? Qt::ItemIsEnabled | Qt::ItemIsSelectable : Qt::NoItemFlags;
}

}  // namespace calot::gui
