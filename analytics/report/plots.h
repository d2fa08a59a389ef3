// SPDX-License-Identifier: GPL-3.0-or-later
// The plots of a report, on a page, on paper and on the screen: boxes with points, effects with intervals, a history,
// distributions of scores.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analytics/report/drawing.h"
#include "analytics/report/ratings.h"
#include "analytics/statistics/regression.h"

namespace calot::analytics {

inline constexpr double plotWidth = 320.0, plotHeight = 240.0;  ///< of a page's plots, in the drawing's units

/// Size of a plot in the drawing's units and its area between the axes. A page's unit is a pixel where it is not
/// scaled; letters keep their size whatever the frame's.
struct PlotFrame {
  double width = plotWidth, height = plotHeight;
  bool legend = false;  ///< space for drawLegend()

  [[nodiscard]] double left() const { return 62.0; }
  [[nodiscard]] double right() const { return width - 10.0; }
  [[nodiscard]] double top() const { return 30.0; }
  [[nodiscard]] double bottom() const { return height - (legend ? 58.0 : 40.0); }
};

struct PlotScale {
  double low = 0.0, high = 1.0;
  PlotFrame frame;
  [[nodiscard]] double y(double value) const {
    return frame.bottom() - (value - low) / (high - low) * (frame.bottom() - frame.top());
  }
  [[nodiscard]] double x(double value) const {
    return frame.left() + (value - low) / (high - low) * (frame.right() - frame.left());
  }
};

/// Holds all values with a margin, not below zero unless a value is; none where they are too large or too close, or
/// there are none.
std::optional<PlotScale> plotScale(std::span<const double> values, const PlotFrame& frame = {});

/// A drawing with its title, a grid with its ticks, and the unit beside them.
Drawing beginPlot(const std::string& title, const std::string& axis, const PlotScale& scale);
/// The watermark over all of it where it is synthetic.
void endPlot(Drawing& drawing, bool synthetic);

struct LegendEntry {
  Ink ink;
  std::string label;
};
/// One line below the plot. @pre the frame has space for it
void drawLegend(Drawing& drawing, const PlotFrame& frame, const std::vector<LegendEntry>& entries);

struct BoxPlot {
  std::string title, axis;  ///< axis: what the values are, with their unit
  std::vector<std::string> groups;
  std::vector<std::span<const double>> values;  ///< of each group
  bool synthetic = false;                       ///< watermarked
  struct Point {
    std::string key, text;   ///< as DrawnMark
    bool synthetic = false;  ///< hollow
  };
  /// The attempt or participant behind a value, or empty: points are not marked.
  std::function<Point(std::size_t group, std::size_t value)> point = {};
  PlotFrame frame = {};
};

/// For each group a box from quartile to quartile (type 7) with the median, whiskers to the outermost
/// values within 1.5 times the box's height (Tukey 1977), and every value as a point beside it; of fewer than five
/// values the points alone, of over 200 every n-th in order, with both extremes, which is said. Groups are named
/// where there is space for names. Values too large or too close for a scale are answered with none, as are groups that
/// are all empty.
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
  struct Value {
    double attempt = 1.0;  ///< its number
    double value = 0.0;
    bool outside = false;             ///< not one of those that the curve is fitted to: hollow
    std::string key = {}, text = {};  ///< as DrawnMark; no key: not marked
  };
  std::string title, axis;  ///< axis: the unit, or empty
  std::vector<Value> values;
  std::optional<double> mark;  ///< a pass mark, drawn as a line
  bool synthetic = false;
  const LearningCurve* curve = nullptr;  ///< drawn with its 95 % band; without one, values are joined
  double attempts = 0.0;                 ///< in all; 0: as many as values
  PlotFrame frame = {};
};

/// Values over the number of the attempt, joined or with their learning curve. No value and no mark, and
/// values too large or too close for a scale, are answered with none.
std::optional<Drawing> drawHistory(const HistoryPlot& plot);

/// Distribution of a form's scores: for each item and group a bar from the lowest to the highest score, with parts
/// proportional to their share and labelled with counts where space permits. One drawing per thirteen items; none for a
/// form that nobody has completed.
std::vector<Drawing> drawScores(const FormReport& form, bool synthetic);

}  // namespace calot::analytics
