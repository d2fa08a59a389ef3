// SPDX-License-Identifier: GPL-3.0-or-later
// What the plots of a page are drawn with.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>

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

std::string plotLine(double x1, double y1, double x2, double y2, const char* kind);
std::string plotLabel(double x, double y, const char* kind, const std::string& text);
/// From <svg> on: title, grid with its ticks, the unit beside them.
std::string plotBegin(const std::string& title, const std::string& axis, const PlotScale& scale);
/// The watermark where it is synthetic, and the end.
std::string plotEnd(bool synthetic);

}  // namespace calot::analytics
