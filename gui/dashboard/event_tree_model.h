// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QStandardItemModel>
#include <vector>

#include "gui/attempt/attempt_track.h"

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

}  // namespace calot::gui
