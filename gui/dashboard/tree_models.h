// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QAbstractItemModel>
#include <QStandardItemModel>
#include <vector>

#include "gui/attempt/attempt_recording.h"
#include "gui/dashboard/checkpoint_table_model.h"

namespace calot::gui {

/// The events of an attempt in groups of what happened, errors first; each says when, to what and by which hand.
class EventTreeModel : public QStandardItemModel {
  Q_OBJECT
 public:
  enum Column { whatColumn, timeColumn, columnTotal };
  enum Role { secondsRole = Qt::UserRole };  ///< double; of a group its first event's

  explicit EventTreeModel(QObject* parent = nullptr);
  void setEvents(const std::vector<TrackEvent>& events);
};

/// The checkpoints of a table, folded by family and sorted within one. Leaves out what the scene has nothing for.
class FamilyTreeModel : public QAbstractItemModel {
  Q_OBJECT
 public:
  /// @param source outlives this
  explicit FamilyTreeModel(CheckpointTableModel& source, QObject* parent = nullptr);

  /// The source's row, or -1 of a family.
  [[nodiscard]] int sourceRow(const QModelIndex& index) const;
  /// Where a row of the source is; invalid where it is left out.
  [[nodiscard]] QModelIndex indexOf(int sourceRow, int column = 0) const;
  [[nodiscard]] int leftOut() const { return leftOut_; }  ///< checkpoints that the scene has nothing for

  [[nodiscard]] QModelIndex index(int row, int column, const QModelIndex& parent = {}) const override;
  [[nodiscard]] QModelIndex parent(const QModelIndex& child) const override;
  [[nodiscard]] int rowCount(const QModelIndex& parent = {}) const override;
  [[nodiscard]] int columnCount(const QModelIndex& parent = {}) const override;
  [[nodiscard]] QVariant data(const QModelIndex& index, int role) const override;
  [[nodiscard]] QVariant headerData(int section, Qt::Orientation orientation, int role) const override;
  [[nodiscard]] Qt::ItemFlags flags(const QModelIndex& index) const override;
  /// Families keep their order. Values go by size within one figure's kind, missing ones last.
  void sort(int column, Qt::SortOrder order) override;

 private:
  struct Family {
    QString title;
    std::vector<int> rows;  ///< of the source
  };
  void group();
  void order();

  CheckpointTableModel& source_;
  std::vector<Family> families_;
  int leftOut_ = 0;
  int sortColumn_ = -1;
  Qt::SortOrder sortOrder_ = Qt::AscendingOrder;
};

}  // namespace calot::gui
