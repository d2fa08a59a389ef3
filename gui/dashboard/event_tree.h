// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QStandardItemModel>
#include <vector>

#include "gui/attempt/replay_player.h"

namespace calot::gui {

/// Puts what happened in an attempt into a tree: its errors, the gravest first, at their worst moments, with their
/// occasions where there are several; then other events in groups. Each says when, to what and by which hand.
void listEvents(QStandardItemModel& tree, const std::vector<TrackEvent>& events,
                const std::vector<analytics::ErrorLine>& errors);
inline constexpr int eventSecondsRole = Qt::UserRole;  ///< double; of a group its first event's

}  // namespace calot::gui
