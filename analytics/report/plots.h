// SPDX-License-Identifier: GPL-3.0-or-later
// The plots of a report: boxes with points, effects with intervals, a history, distributions of scores.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analytics/report/drawing.h"
#include "analytics/report/ratings.h"

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

struct BoxPlot {
  std::string title, axis;  ///< axis: what the values are, with their unit
  std::array<std::string, 2> groups;
  std::array<std::span<const double>, 2> values;
  bool synthetic = false;  ///< watermarked
};

/// For each group a box from quartile to quartile (type 7) with the median, whiskers to the outermost
/// values within 1.5 times the box's height (Tukey 1977), and every value as a point beside it; of fewer than five
/// values the points alone, of over 200 one in so many in order, with both extremes, which is said. Values too large or
/// too close for a scale are answered with none, as are two empty groups.
std::optional<Drawing> drawBoxPlot(const BoxPlot& plot);

/// Four to nine round numbers (1, 2 or 5 times a power of ten apart) that lie within [low, high].
/// @pre low < high, finite
std::vector<double> roundTicks(double low, double high);

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

struct HistoryPlot {
  std::string title, axis;     ///< axis: the unit, or empty
  std::vector<double> values;  ///< of the first attempt, the second, ...
  std::optional<double> mark;  ///< a pass mark, drawn as a line
  bool synthetic = false;
};

/// Values over the number of the attempt, joined. Fewer than two values, and values too large or too
/// close for a scale, are answered with none.
std::optional<Drawing> drawHistory(const HistoryPlot& plot);

/// Distribution of a form's scores: for each item and group a bar from the lowest to the highest score, with parts
/// proportional to their share and labelled with counts where space permits. One drawing per thirteen items; none for a
/// form that nobody has completed.
std::vector<Drawing> drawScores(const FormReport& form, bool synthetic);

}  // namespace calot::analytics
