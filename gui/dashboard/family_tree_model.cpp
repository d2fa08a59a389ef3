// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/family_tree_model.h"

#include <map>
#include <QFont>

#include "analytics/report/key_figures.h"
#include "gui/attempt/figure_text.h"

namespace calot::gui {
namespace {

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
