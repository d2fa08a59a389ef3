// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <QAbstractTableModel>

#include "gui/dashboard/attempt_lines.h"

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

}  // namespace calot::gui
