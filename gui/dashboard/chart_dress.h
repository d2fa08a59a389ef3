// SPDX-License-Identifier: GPL-3.0-or-later
// Charts in the colours and letters of the application.
#pragma once

#include <QtCharts/QChart>

namespace calot::gui {

/// Of ground, title, legend and the axes that are there.
void dress(QChart& chart);

/// Where an axis of these values begins and ends, and how far its ticks stand apart. It begins where the values do: a
/// little below the least, at a tick or not.
struct AxisSpan {
  double from = 0.0, to = 1.0, interval = 0.2;
};
/// @pre lower <= upper
[[nodiscard]] AxisSpan axisSpan(double lower, double upper);

}  // namespace calot::gui
