// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analytics/report/drawing.h"

namespace calot::analytics {

struct HistoryPlot {
  std::string title, axis;     ///< axis: the unit, or empty
  std::vector<double> values;  ///< of the first attempt, the second, ...
  std::optional<double> mark;  ///< a pass mark, drawn as a line
  bool synthetic = false;
};

/// Values over the number of the attempt, joined. Fewer than two values, and values too large or too
/// close for a scale, are answered with none.
std::optional<Drawing> drawHistory(const HistoryPlot& plot);

}  // namespace calot::analytics
