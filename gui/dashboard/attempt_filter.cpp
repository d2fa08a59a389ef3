// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/attempt_filter.h"

#include <algorithm>
#include <vector>

#include "gui/dashboard/attempt_table_model.h"

namespace calot::gui {

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
