// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/report/plots.h"

#include <fmt/format.h>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <utility>

#include "analytics/report/report_text.h"
#include "analytics/statistics/descriptive.h"

namespace calot::analytics {
namespace {

constexpr std::size_t maxPlotTitle = 42;  // in letters: what fits at the size of page_html.cpp

}  // namespace

std::optional<PlotScale> plotScale(std::span<const double> values) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const double v : values) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  const double size = std::max(std::abs(low), std::abs(high));
  if (!(low <= high) || size > 1e300) return std::nullopt;
  if (low == high) {
    const double around = size > 0.0 ? size * 0.1 : 1.0;
    low -= around;
    high += around;
  }
  if (!(high - low > size * 1e-12)) return std::nullopt;
  const double margin = (high - low) * 0.05;
  return PlotScale{low - margin, high + margin};
}

Drawing beginPlot(const std::string& title, const std::string& axis, const PlotScale& scale) {
  Drawing drawing{title, plotWidth, plotHeight, {}};
  drawing.text(Ink::heading, 12.0, 18.0, cutTo(title, maxPlotTitle));
  for (const double tick : roundTicks(scale.low, scale.high)) {
    drawing.line(Ink::grid, plotLeft, scale.y(tick), plotRight, scale.y(tick));
    drawing.text(Ink::tick, plotLeft - 6.0, scale.y(tick) + 4.0, fmt::format("{:.6g}", tick == 0.0 ? 0.0 : tick));
  }
  if (!axis.empty()) drawing.text(Ink::axis, 12.0, (plotTop + plotBottom) / 2.0, axis, -90.0);
  return drawing;
}

void endPlot(Drawing& drawing, bool synthetic) {
  if (!synthetic) return;
  drawing.text(Ink::watermark, drawing.width / 2.0, drawing.height / 2.0 + 14.0, "SYNTHETIC", -30.0);
}

namespace {

constexpr std::size_t maxGroup = 20;     // in letters
constexpr std::size_t minBox = 5;        // values: quartiles of fewer are interpolations between two of them
constexpr std::size_t mostPoints = 200;  // drawn of a group: more are one dark column, and a report of megabytes
constexpr double boxHalf = 26.0, pointRadius = 2.6;

void drawBox(Drawing& drawing, const std::vector<double>& sorted, double x, const PlotScale& scale, std::size_t g) {
  const double q1 = quantileOfSorted(sorted, 0.25), q2 = quantileOfSorted(sorted, 0.5),
               q3 = quantileOfSorted(sorted, 0.75);
  const double reach = 1.5 * (q3 - q1);
  const double lower = std::min(q1, *std::lower_bound(sorted.begin(), sorted.end(), q1 - reach));
  const double upper = std::max(q3, *(std::upper_bound(sorted.begin(), sorted.end(), q3 + reach) - 1));
  drawing.line(Ink::whisker, x, scale.y(lower), x, scale.y(q1));
  drawing.line(Ink::whisker, x, scale.y(q3), x, scale.y(upper));
  drawing.line(Ink::whisker, x - boxHalf / 2, scale.y(lower), x + boxHalf / 2, scale.y(lower));
  drawing.line(Ink::whisker, x - boxHalf / 2, scale.y(upper), x + boxHalf / 2, scale.y(upper));
  drawing.box(g == 0 ? Ink::firstBox : Ink::secondBox, x - boxHalf, scale.y(q3), 2 * boxHalf,
              std::max(0.0, scale.y(q1) - scale.y(q3)));
  drawing.line(Ink::median, x - boxHalf, scale.y(q2), x + boxHalf, scale.y(q2));
}

/// Every value is drawn, or one in so many of those in order.
std::size_t strideOf(std::size_t values) { return 1 + (values - 1) / mostPoints; }

void drawGroup(Drawing& drawing, std::span<const double> values, double x, const PlotScale& scale, std::size_t g) {
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  if (sorted.size() >= minBox) drawBox(drawing, sorted, x, scale, g);
  const auto draw = [&](std::size_t i, std::size_t place) {
    // Side by side in five places in turn, so that equal values do not hide each other.
    const double aside = (static_cast<double>(place * 2 % 5) - 2.0) * 7.0;
    drawing.point(g == 0 ? Ink::firstPoint : Ink::secondPoint, x + aside, scale.y(sorted[i]), pointRadius);
  };
  const std::size_t stride = strideOf(sorted.size());
  for (std::size_t i = 0; i + 1 < sorted.size(); i += stride) draw(i, i / stride);
  draw(sorted.size() - 1, (sorted.size() - 1) / stride);  // both extremes, always
}

}  // namespace

std::vector<double> roundTicks(double low, double high) {
  assert(low < high && std::isfinite(high - low));
  const double rough = (high - low) / 5.0, power = std::pow(10.0, std::floor(std::log10(rough)));
  const double step = power * (rough < 1.5 * power   ? 1.0
                               : rough < 3.5 * power ? 2.0
                               : rough < 7.5 * power ? 5.0
                                                     : 10.0);
  std::vector<double> ticks;
  const double first = std::ceil(low / step), last = std::floor(high / step);
  for (double k = first; k <= last && ticks.size() < 20; k += 1.0) ticks.push_back(k * step);
  return ticks;
}

std::optional<Drawing> drawBoxPlot(const BoxPlot& plot) {
  std::vector<double> all;
  for (const auto& values : plot.values) all.insert(all.end(), values.begin(), values.end());
  const std::optional<PlotScale> scale = plotScale(all);
  if (!scale) return std::nullopt;
  Drawing drawing = beginPlot(plot.title, plot.axis, *scale);
  for (std::size_t g = 0; g < 2; ++g) {
    const double x = plotLeft + (plotRight - plotLeft) * (g == 0 ? 0.27 : 0.73);
    drawing.text(Ink::group, x, plotBottom + 17.0, cutTo(plot.groups[g], maxGroup));
    const std::size_t n = plot.values[g].size();
    const bool each = n == 0 || strideOf(n) == 1;
    drawing.text(Ink::group, x, plotBottom + 32.0,
                 each ? fmt::format("n = {}", n) : fmt::format("n = {}, one in {} drawn", n, strideOf(n)));
    if (n > 0) drawGroup(drawing, plot.values[g], x, *scale, g);
  }
  endPlot(drawing, plot.synthetic);
  return drawing;
}

namespace {

constexpr double forestWidth = 2.0 * plotWidth, axisLeft = 225.0, axisRight = 480.0, axisTop = 40.0, rowHeight = 20.0,
                 footHeight = 46.0;
constexpr double effectRadius = 4.0;
constexpr std::size_t maxForestLabel = 34, maxForestTitle = 90, maxMeaning = 30;  // in letters: width available

double axisAt(double value) { return axisLeft + value * (axisRight - axisLeft); }

}  // namespace

Drawing drawForest(const ForestPlot& plot) {
  assert(!plot.rows.empty());
  const double bottom = axisTop + rowHeight * static_cast<double>(plot.rows.size());
  Drawing drawing{plot.title, forestWidth, bottom + footHeight, {}};
  drawing.text(Ink::heading, 12.0, 18.0, cutTo(plot.title, maxForestTitle));
  for (int quarter = 0; quarter <= 4; ++quarter) {
    const double value = 0.25 * quarter;
    drawing.line(quarter == 2 ? Ink::cut : Ink::grid, axisAt(value), axisTop - 6.0, axisAt(value), bottom);
    drawing.text(Ink::count, axisAt(value), bottom + 14.0, fmt::format("{:g}", value));
  }
  drawing.text(Ink::count, axisAt(0.2), bottom + 32.0, cutTo(plot.below, maxMeaning));
  drawing.text(Ink::count, axisAt(0.8), bottom + 32.0, cutTo(plot.above, maxMeaning));
  double y = axisTop + 0.5 * rowHeight;
  for (const ForestRow& row : plot.rows) {
    drawing.text(Ink::label, 12.0, y + 4.0, cutTo(row.label, maxForestLabel));
    drawing.line(Ink::median, axisAt(row.lower), y, axisAt(row.upper), y);
    drawing.point(Ink::firstPoint, axisAt(row.value), y, effectRadius);
    drawing.text(Ink::label, axisRight + 16.0, y + 4.0,
                 fmt::format("{:.2f} [{:.2f}, {:.2f}]", row.value, row.lower, row.upper));
    y += rowHeight;
  }
  endPlot(drawing, plot.synthetic);
  return drawing;
}

std::optional<Drawing> drawHistory(const HistoryPlot& plot) {
  if (plot.values.size() < 2) return std::nullopt;
  std::vector<double> all = plot.values;
  if (plot.mark) all.push_back(*plot.mark);
  const std::optional<PlotScale> scale = plotScale(all);
  if (!scale) return std::nullopt;
  Drawing drawing = beginPlot(plot.title, plot.axis, *scale);
  if (plot.mark) drawing.line(Ink::cut, plotLeft, scale->y(*plot.mark), plotRight, scale->y(*plot.mark));
  const double apart = (plotRight - plotLeft) / static_cast<double>(plot.values.size());
  const auto x = [&](std::size_t i) { return plotLeft + apart * (static_cast<double>(i) + 0.5); };
  for (std::size_t i = 1; i < plot.values.size(); ++i)
    drawing.line(Ink::whisker, x(i - 1), scale->y(plot.values[i - 1]), x(i), scale->y(plot.values[i]));
  for (std::size_t i = 0; i < plot.values.size(); ++i) {
    drawing.point(Ink::firstPoint, x(i), scale->y(plot.values[i]), 3.0);
    if (plot.values.size() <= 12) drawing.text(Ink::group, x(i), plotBottom + 17.0, fmt::format("{}", i + 1));
  }
  drawing.text(Ink::group, (plotLeft + plotRight) / 2.0, plotBottom + 32.0, "attempt");
  endPlot(drawing, plot.synthetic);
  return drawing;
}

namespace {

constexpr std::size_t itemsOfDrawing = 13;
constexpr double width = 640.0, barLeft = 130.0, barRight = 570.0, top = 34.0;
constexpr double labelHeight = 18.0, barHeight = 14.0, barApart = 18.0, itemGap = 8.0, legendHeight = 40.0;
constexpr std::size_t maxItem = 100, maxScoreTitle = 90;  // in letters: width available
constexpr int mostNamed = 11;                             // scores that a legend lists

/// Saturation grows with distance from the middle of the scale, symmetrically.
Ink inkOf(int score, const FormReport& form) {
  constexpr Ink low[] = {Ink::middle, Ink::low1, Ink::low2, Ink::low3};
  constexpr Ink high[] = {Ink::middle, Ink::high1, Ink::high2, Ink::high3};
  const double side = (2.0 * score - form.least - form.most) / (form.most - form.least);
  const auto strength = static_cast<std::size_t>(std::lround(std::min(1.0, std::abs(side)) * 3.0));
  return side < 0.0 ? low[strength] : high[strength];
}

void drawBar(Drawing& drawing, double y, const ItemSummary& group, const FormReport& form) {
  std::uint64_t all = 0;
  for (const auto& [score, count] : group.counts) all += count;
  if (all == 0) {
    drawing.text(Ink::label, barLeft, y + barHeight - 3.0, "no answers");
    return;
  }
  double x = barLeft;
  for (const auto& [score, count] : group.counts) {
    const double part = (barRight - barLeft) * static_cast<double>(count) / static_cast<double>(all);
    drawing.box(inkOf(score, form), x, y, part, barHeight);
    const std::string text = fmt::format("{}", count);
    if (part > 7.0 * static_cast<double>(text.size()) + 4.0)
      drawing.text(Ink::count, x + part / 2.0, y + barHeight - 3.5, text);
    x += part;
  }
  drawing.text(Ink::label, barRight + 8.0, y + barHeight - 3.0, fmt::format("n = {}", all));
}

void drawLegend(Drawing& drawing, double y, const FormReport& form) {
  const int steps = form.most - form.least;
  const double apart = (barRight - barLeft) / (steps + 1);
  for (int score = form.least; score <= form.most; ++score) {
    const double x = barLeft + apart * (score - form.least);
    drawing.box(inkOf(score, form), x, y, apart, 8.0);
    if (steps < mostNamed || score == form.least || score == form.most)
      drawing.text(Ink::count, x + apart / 2.0, y + 20.0, fmt::format("{}", score));
  }
  drawing.text(Ink::tick, barLeft - 8.0, y + 8.0, "score");
}

}  // namespace

std::vector<Drawing> drawScores(const FormReport& form, bool synthetic) {
  std::vector<Drawing> drawings;
  if (form.filled == 0 || form.least >= form.most) return drawings;
  const std::size_t pages = (form.items.size() + itemsOfDrawing - 1) / itemsOfDrawing;
  const double itemHeight = labelHeight + barApart * static_cast<double>(form.groups.size()) + itemGap;
  for (std::size_t page = 0; page < pages; ++page) {
    const std::size_t begin = page * itemsOfDrawing, end = std::min(form.items.size(), begin + itemsOfDrawing);
    std::string title = fmt::format("{} ({} {})", form.title, form.name, form.version);
    if (pages > 1) title += fmt::format(", {} of {}", page + 1, pages);
    Drawing drawing{title, width, top + itemHeight * static_cast<double>(end - begin) + legendHeight, {}};
    drawing.text(Ink::heading, 12.0, 18.0, cutTo(title, maxScoreTitle));
    double y = top;
    for (std::size_t i = begin; i < end; ++i) {
      const ItemReport& item = form.items[i];
      drawing.text(Ink::label, 12.0, y + 12.0, cutTo(item.text.empty() ? item.key : item.text, maxItem));
      y += labelHeight;
      for (std::size_t g = 0; g < form.groups.size(); ++g) {
        drawing.text(Ink::tick, barLeft - 8.0, y + barHeight - 3.5, cutTo(form.groups[g], maxGroup));
        drawBar(drawing, y, item.groups[g], form);
        y += barApart;
      }
      y += itemGap;
    }
    drawLegend(drawing, y, form);
    endPlot(drawing, synthetic);
    drawings.push_back(std::move(drawing));
  }
  return drawings;
}

}  // namespace calot::analytics
