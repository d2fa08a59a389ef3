// SPDX-License-Identifier: GPL-3.0-or-later
// Common parts of the plots of a page.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>

#include "analytics/report/drawing.h"

namespace calot::analytics {

// In the drawing's own units, as many as pixels where the page is not scaled.
inline constexpr double plotWidth = 320.0, plotHeight = 240.0;
inline constexpr double plotLeft = 62.0, plotRight = 310.0, plotTop = 30.0, plotBottom = 200.0;

struct PlotScale {
  double low = 0.0, high = 1.0;
  [[nodiscard]] double y(double value) const {
    return plotBottom - (value - low) / (high - low) * (plotBottom - plotTop);
  }
};

/// Holds all values with a margin; none where they are too large or too close, or there are none.
std::optional<PlotScale> plotScale(std::span<const double> values);

/// A drawing with its title, a grid with its ticks, and the unit beside them.
Drawing beginPlot(const std::string& title, const std::string& axis, const PlotScale& scale);
/// The watermark over all of it where it is synthetic.
void endPlot(Drawing& drawing, bool synthetic);

}  // namespace calot::analytics
