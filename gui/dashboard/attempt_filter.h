// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <QSortFilterProxyModel>
#include <QStringList>
#include <string>

#include "analytics/cohort/cohort_database.h"

namespace calot::gui {

/// Which attempts the table shows, and in which order.
class AttemptFilter : public QSortFilterProxyModel {
  Q_OBJECT
 public:
  enum class Operators { all, people, synthetic };

  explicit AttemptFilter(QObject* parent = nullptr);
  /// Every word of the text must be found somewhere in the row; case does not matter.
  void setSearch(const QString& text);
  void setVerdict(std::optional<analytics::Verdict> verdict);
  void setOperators(Operators operators);
  void setTag(const QString& tag);  ///< empty: any, or none

 protected:
  [[nodiscard]] bool filterAcceptsRow(int sourceRow, const QModelIndex& sourceParent) const override;

 private:
  /// The whole table is laid out anew: rows that go one by one, as invalidateFilter() has them, take seconds of
  /// thousands.
  void refilter() { invalidate(); }

  QStringList words_;
  std::string tag_;
  std::optional<analytics::Verdict> verdict_;
  Operators operators_ = Operators::all;
};

}  // namespace calot::gui
