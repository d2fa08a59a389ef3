// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QStandardItemModel>

#include "gui/dashboard/checkpoint_table_model.h"

namespace calot::gui {

/// The checkpoints of a table, folded by family and sorted within one. Leaves out what the scene has nothing for.
class FamilyTreeModel : public QStandardItemModel {
  Q_OBJECT
 public:
  /// @param source outlives this
  explicit FamilyTreeModel(const CheckpointTableModel& source);

  /// The source's row, or -1 of a family.
  [[nodiscard]] int sourceRow(const QModelIndex& index) const;
  /// Position of a row of the source; invalid if it is left out.
  [[nodiscard]] QModelIndex indexOf(int sourceRow) const;
  [[nodiscard]] int leftOut() const { return leftOut_; }  ///< checkpoints that the scene has nothing for

  [[nodiscard]] QVariant data(const QModelIndex& index, int role) const override;
  void multiData(const QModelIndex& index, QModelRoleDataSpan roles) const override {
    QAbstractItemModel::multiData(index, roles);  // by data(): items hold no cells
  }
  [[nodiscard]] QVariant headerData(int section, Qt::Orientation orientation, int role) const override;
  [[nodiscard]] Qt::ItemFlags flags(const QModelIndex&) const override {
    return Qt::ItemIsEnabled | Qt::ItemIsSelectable;
  }
  /// Families keep their order. Values go by size within one figure's kind, missing ones last. @param column -1: as in
  /// the source
  void sort(int column, Qt::SortOrder order) override;

 private:
  class Entry;
  void fill();
  [[nodiscard]] bool isBefore(int a, int b) const;  ///< rows of the source

  const CheckpointTableModel& source_;
  int leftOut_ = 0;
  int sortColumn_ = -1;
  Qt::SortOrder sortOrder_ = Qt::AscendingOrder;
};

}  // namespace calot::gui
