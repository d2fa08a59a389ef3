// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/box_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "analytics/report/plot_parts.h"
#include "analytics/report/text_table.h"
#include "analytics/statistics/descriptive.h"

namespace calot::analytics {
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

}  // namespace calot::analytics
