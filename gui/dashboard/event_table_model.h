// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QAbstractTableModel>
#include <vector>

#include "gui/dashboard/attempt_track.h"

namespace calot::gui {

/// The events of an attempt as a list, to be gone through by keyboard.
class EventTableModel : public QAbstractTableModel {
  Q_OBJECT
 public:
  enum Column { timeColumn, textColumn, columnTotal };

  using QAbstractTableModel::QAbstractTableModel;
  void setEvents(std::vector<TrackEvent> events);
  /// @pre 0 <= row < rowCount()
  [[nodiscard]] const TrackEvent& at(int row) const { return events_[static_cast<std::size_t>(row)]; }

  [[nodiscard]] int rowCount(const QModelIndex& parent = {}) const override;
  [[nodiscard]] int columnCount(const QModelIndex& parent = {}) const override;
  [[nodiscard]] QVariant data(const QModelIndex& index, int role) const override;
  [[nodiscard]] QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

 private:
  std::vector<TrackEvent> events_;
};

}  // namespace calot::gui
