// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QAbstractTableModel>
#include <vector>

#include "analytics/cohort/cohort_database.h"

namespace calot::gui {

/// The attempts of a cohort as a table, one row each.
class AttemptTableModel : public QAbstractTableModel {
  Q_OBJECT
 public:
  enum Column {
    attemptColumn,
    operatorColumn,
    groupColumn,
    sceneColumn,
    modeColumn,
    outcomeColumn,
    startColumn,
    verificationColumn,
    syntheticColumn,
    columnTotal
  };
  enum Role {
    sortRole = Qt::UserRole,  ///< what a column is ordered by
    searchRole,               ///< QString: all that the search box looks through, lower case; same for every column
    verdictRole,              ///< int: analytics::Verdict
    syntheticRole,            ///< bool
    uuidRole,                 ///< QString
  };

  using QAbstractTableModel::QAbstractTableModel;
  void setAttempts(std::vector<analytics::AttemptRow> attempts);
  /// @pre 0 <= row < rowCount()
  [[nodiscard]] const analytics::AttemptRow& attempt(int row) const { return attempts_[static_cast<std::size_t>(row)]; }

  [[nodiscard]] int rowCount(const QModelIndex& parent = {}) const override;
  [[nodiscard]] int columnCount(const QModelIndex& parent = {}) const override;
  [[nodiscard]] QVariant data(const QModelIndex& index, int role) const override;
  [[nodiscard]] QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

 private:
  std::vector<analytics::AttemptRow> attempts_;
};

}  // namespace calot::gui
