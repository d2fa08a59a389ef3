// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "analytics/report/drawing.h"

namespace calot::analytics {

/// One effect with its interval. @invariant 0 <= lower <= value <= upper <= 1
struct ForestRow {
  std::string label;
  double value = 0.5, lower = 0.0, upper = 1.0;
};

struct ForestPlot {
  std::string title;
  std::string below, above;  ///< what A below and above one half means, under the axis
  std::vector<ForestRow> rows;
  bool synthetic = false;  ///< watermarked
};

/// Probabilities of superiority one below the other on an axis from 0 to 1, each with its interval as a line and as
/// numbers; dashed at one half, where there is no difference (Lewis and Clarke 2001, BMJ 322:1479). @pre there are rows
Drawing drawForest(const ForestPlot& plot);

}  // namespace calot::analytics
