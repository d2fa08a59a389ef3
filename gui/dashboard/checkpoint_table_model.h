// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QAbstractTableModel>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"

namespace calot::gui {

/// The checkpoints of one attempt. A value that is missing says why; what a value declares stands beside it.
class CheckpointTableModel : public QAbstractTableModel {
  Q_OBJECT
 public:
  enum Column {
    nameColumn,
    subjectColumn,
    valueColumn,
    directionColumn,
    windowColumn,
    originColumn,
    versionColumn,
    columnTotal
  };

  using QAbstractTableModel::QAbstractTableModel;
  void setValues(std::vector<analytics::CheckpointValue> values);

  [[nodiscard]] int rowCount(const QModelIndex& parent = {}) const override;
  [[nodiscard]] int columnCount(const QModelIndex& parent = {}) const override;
  [[nodiscard]] QVariant data(const QModelIndex& index, int role) const override;
  [[nodiscard]] QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

 private:
  std::vector<analytics::CheckpointValue> values_;
};

}  // namespace calot::gui
