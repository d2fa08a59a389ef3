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

constexpr std::size_t longestGroup = 20;  // in letters
constexpr double boxHalf = 26.0, pointRadius = 2.6;

std::string group(std::span<const double> values, double x, const PlotScale& scale, const char* kind) {
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const double q1 = quantileOfSorted(sorted, 0.25), q2 = quantileOfSorted(sorted, 0.5),
               q3 = quantileOfSorted(sorted, 0.75);
  const double reach = 1.5 * (q3 - q1);
  const double lower = std::min(q1, *std::lower_bound(sorted.begin(), sorted.end(), q1 - reach));
  const double upper = std::max(q3, *(std::upper_bound(sorted.begin(), sorted.end(), q3 + reach) - 1));
  std::string svg = fmt::format("<g class=\"{}\">\n", kind);
  svg +=
      plotLine(x, scale.y(lower), x, scale.y(q1), "whisker") + plotLine(x, scale.y(q3), x, scale.y(upper), "whisker");
  svg += plotLine(x - boxHalf / 2, scale.y(lower), x + boxHalf / 2, scale.y(lower), "whisker");
  svg += plotLine(x - boxHalf / 2, scale.y(upper), x + boxHalf / 2, scale.y(upper), "whisker");
  svg += fmt::format("<rect class=\"box\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"/>\n",
                     x - boxHalf, scale.y(q3), 2 * boxHalf, std::max(0.0, scale.y(q1) - scale.y(q3)));
  svg += plotLine(x - boxHalf, scale.y(q2), x + boxHalf, scale.y(q2), "median");
  // Side by side in five places in turn, so that equal values do not hide each other.
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const double aside = (static_cast<double>(i * 2 % 5) - 2.0) * 7.0;
    svg += fmt::format("<circle class=\"point\" cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{}\"/>\n", x + aside,
                       scale.y(sorted[i]), pointRadius);
  }
  return svg + "</g>\n";
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

std::string boxPlotSvg(const BoxPlot& plot) {
  std::vector<double> all;
  for (const auto& values : plot.values) all.insert(all.end(), values.begin(), values.end());
  const std::optional<PlotScale> scale = plotScale(all);
  if (!scale) return {};
  std::string svg = plotBegin(plot.title, plot.axis, *scale);
  for (std::size_t g = 0; g < 2; ++g) {
    const double x = plotLeft + (plotRight - plotLeft) * (g == 0 ? 0.27 : 0.73);
    svg += plotLabel(x, plotBottom + 17.0, "group", cutTo(plot.groups[g], longestGroup));
    svg += plotLabel(x, plotBottom + 32.0, "group", fmt::format("n = {}", plot.values[g].size()));
    if (!plot.values[g].empty()) svg += group(plot.values[g], x, *scale, g == 0 ? "first" : "second");
  }
  return svg + plotEnd(plot.synthetic);
}

}  // namespace calot::analytics
