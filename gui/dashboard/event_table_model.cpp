// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/event_table_model.h"

namespace calot::gui {

void EventTableModel::setEvents(std::vector<TrackEvent> events) {
  beginResetModel();
  events_ = std::move(events);
  endResetModel();
}

int EventTableModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(events_.size());
}
int EventTableModel::columnCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : columnTotal; }

QVariant EventTableModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid() || index.row() >= rowCount()) return {};
  const TrackEvent& event = at(index.row());
  if (role == Qt::DisplayRole && index.column() == timeColumn) return QString::fromStdString(timeText(event.time));
  if (role == Qt::DisplayRole)
    return QString::fromUtf8(event.error ? "▲ " : "   ") + QString::fromStdString(event.text);
  if (role == Qt::ToolTipRole && event.error) return QStringLiteral("Something that should not happen");
  return {};
}

QVariant EventTableModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole) return {};
  return section == timeColumn ? QStringLiteral("Time") : QStringLiteral("Event");
}

}  // namespace calot::gui
