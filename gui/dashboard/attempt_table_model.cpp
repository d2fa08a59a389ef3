// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/attempt_table_model.h"

#include <QFont>

#include "gui/attempt/words.h"

namespace calot::gui {

void AttemptTableModel::setLines(std::shared_ptr<const AttemptLines> lines) {
  beginResetModel();
  lines_ = std::move(lines);
  endResetModel();
}

int AttemptTableModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() || !lines_ ? 0 : static_cast<int>(lines_->attempts().size());
}
int AttemptTableModel::columnCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : columnTotal; }

QVariant AttemptTableModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid() || index.row() >= rowCount() || index.column() >= columnTotal) return {};
  const analytics::AttemptRow& row = attempt(index.row());
  switch (role) {
    case Qt::DisplayRole:
      return lines_->cell(index.row(), index.column());
    case sortRole:
      return lines_->rank(index.row(), index.column());
    case searchRole:
      return lines_->search(index.row());
    case verdictRole:
      return static_cast<int>(row.verification.verdict);
    case syntheticRole:
      return row.synthetic;
    case uuidRole:
      return QString::fromStdString(row.uuid);
    case Qt::ForegroundRole:
      if (index.column() == verificationColumn) return badgeOf(row).colour;
      return {};
    case Qt::FontRole: {
      QFont font;
      if (index.column() == verificationColumn) font.setBold(true);
      if (index.column() == syntheticColumn) font.setItalic(true);
      return font;
    }
    case Qt::ToolTipRole:
      if (index.column() == attemptColumn) return QString::fromStdString(row.uuid);
      if (index.column() == verificationColumn) return badgeOf(row).explanation;
      if (index.column() == syntheticColumn && row.synthetic) return "Made by a performer, not by a person.";
      if (index.column() == outcomeColumn && row.excluded) return QString::fromStdString(row.exclusionReason);
      if (index.column() == tagsColumn) return lines_->cell(index.row(), tagsColumn);
      return {};
    default:
      return {};
  }
}

QVariant AttemptTableModel::headerData(int section, Qt::Orientation orientation, int role) const {
  static constexpr const char* titles[columnTotal] = {
      "Attempt", "Participant or profile", "Group",     "Scene", "Mode", "Outcome",
      "Start",   "Verification",           "Synthetic", "Tags"};
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole || section < 0 || section >= columnTotal) return {};
  return QString(titles[section]);
}

}  // namespace calot::gui
