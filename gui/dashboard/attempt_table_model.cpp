// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/attempt_table_model.h"

#include <algorithm>
#include <QFont>
#include <vector>

#include "gui/attempt/figure_text.h"

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

AttemptFilter::AttemptFilter(QObject* parent) : QSortFilterProxyModel(parent) {
  setSortRole(AttemptTableModel::sortRole);
}

void AttemptFilter::setSearch(const QString& text) {
  words_ = text.toLower().split(' ', Qt::SkipEmptyParts);
  refilter();
}

void AttemptFilter::setVerdict(std::optional<analytics::Verdict> verdict) {
  verdict_ = verdict;
  refilter();
}

void AttemptFilter::setOperators(Operators operators) {
  operators_ = operators;
  refilter();
}

void AttemptFilter::setTag(const QString& tag) {
  if (tag_ == tag.toStdString()) return;
  tag_ = tag.toStdString();
  refilter();
}

bool AttemptFilter::filterAcceptsRow(int sourceRow, const QModelIndex& sourceParent) const {
  const QModelIndex index = sourceModel()->index(sourceRow, 0, sourceParent);
  if (!tag_.empty()) {
    const auto* model = qobject_cast<const AttemptTableModel*>(sourceModel());
    const std::vector<std::string>& tags = model->attempt(sourceRow).tags;
    if (std::find(tags.begin(), tags.end(), tag_) == tags.end()) return false;
  }
  if (verdict_ && index.data(AttemptTableModel::verdictRole).toInt() != static_cast<int>(*verdict_)) return false;
  const bool synthetic = index.data(AttemptTableModel::syntheticRole).toBool();
  if (operators_ == Operators::people && synthetic) return false;
  if (operators_ == Operators::synthetic && !synthetic) return false;
  if (words_.isEmpty()) return true;
  const QString text = index.data(AttemptTableModel::searchRole).toString();
  return std::all_of(words_.begin(), words_.end(), [&](const QString& word) { return text.contains(word); });
}

}  // namespace calot::gui
