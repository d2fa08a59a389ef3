// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <QAbstractTableModel>
#include <QSortFilterProxyModel>
#include <QStringList>
#include <string>

#include "analytics/cohort/cohort_database.h"
#include "gui/dashboard/cohort_document.h"

namespace calot::gui {

/// The attempts of a cohort as a table, one row each.
class AttemptTableModel : public QAbstractTableModel {
  Q_OBJECT
 public:
  using enum AttemptLines::Column;
  enum Role {
    sortRole = Qt::UserRole,  ///< int: what a column is ordered by
    searchRole,               ///< QString: all that the search box looks through, lower case; same for every column
    verdictRole,              ///< int: analytics::Verdict
    syntheticRole,            ///< bool
    uuidRole,                 ///< QString
  };

  using QAbstractTableModel::QAbstractTableModel;
  /// @pre not null
  void setLines(std::shared_ptr<const AttemptLines> lines);
  /// @pre 0 <= row < rowCount()
  [[nodiscard]] const analytics::AttemptRow& attempt(int row) const {
    return lines_->attempts()[static_cast<std::size_t>(row)];
  }

  [[nodiscard]] int rowCount(const QModelIndex& parent = {}) const override;
  [[nodiscard]] int columnCount(const QModelIndex& parent = {}) const override;
  [[nodiscard]] QVariant data(const QModelIndex& index, int role) const override;
  [[nodiscard]] QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

 private:
  std::shared_ptr<const AttemptLines> lines_;
};

/// Filter and order of the attempts in the table.
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
