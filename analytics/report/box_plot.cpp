// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/box_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "analytics/report/html_text.h"
#include "analytics/report/text_table.h"
#include "analytics/statistics/descriptive.h"

namespace calot::analytics {
namespace {

// In the drawing's own units, as many as pixels where the page is not scaled.
constexpr double width = 320.0, height = 240.0;
constexpr double left = 62.0, right = 310.0, top = 30.0, bottom = 200.0;
// In letters: what has room at the sizes of study_html.cpp.
constexpr std::size_t longestTitle = 42, longestGroup = 20;
constexpr double boxHalf = 26.0, pointRadius = 2.6;

struct Scale {
  double low = 0.0, high = 1.0;
  [[nodiscard]] double y(double value) const { return bottom - (value - low) / (high - low) * (bottom - top); }
};

std::string line(double x1, double y1, double x2, double y2, const char* kind) {
  return fmt::format("<line class=\"{}\" x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\"/>\n", kind, x1, y1, x2,
                     y2);
}

std::string label(double x, double y, const char* kind, const std::string& text) {
  return fmt::format("<text class=\"{}\" x=\"{:.2f}\" y=\"{:.2f}\">{}</text>\n", kind, x, y, escaped(text));
}

std::string group(std::span<const double> values, double x, const Scale& scale, const char* kind) {
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const double q1 = quantileOfSorted(sorted, 0.25), q2 = quantileOfSorted(sorted, 0.5),
               q3 = quantileOfSorted(sorted, 0.75);
  const double reach = 1.5 * (q3 - q1);
  const double lower = std::min(q1, *std::lower_bound(sorted.begin(), sorted.end(), q1 - reach));
  const double upper = std::max(q3, *(std::upper_bound(sorted.begin(), sorted.end(), q3 + reach) - 1));
  std::string svg = fmt::format("<g class=\"{}\">\n", kind);
  svg += line(x, scale.y(lower), x, scale.y(q1), "whisker") + line(x, scale.y(q3), x, scale.y(upper), "whisker");
  svg += line(x - boxHalf / 2, scale.y(lower), x + boxHalf / 2, scale.y(lower), "whisker");
  svg += line(x - boxHalf / 2, scale.y(upper), x + boxHalf / 2, scale.y(upper), "whisker");
  svg += fmt::format("<rect class=\"box\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"/>\n",
                     x - boxHalf, scale.y(q3), 2 * boxHalf, std::max(0.0, scale.y(q1) - scale.y(q3)));
  svg += line(x - boxHalf, scale.y(q2), x + boxHalf, scale.y(q2), "median");
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
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const auto& values : plot.values) {
    for (const double v : values) {
      low = std::min(low, v);
      high = std::max(high, v);
    }
  }
  const double size = std::max(std::abs(low), std::abs(high));
  if (!(low <= high) || size > 1e300) return {};
  if (low == high) {
    const double around = size > 0.0 ? size * 0.1 : 1.0;
    low -= around;
    high += around;
  }
  if (!(high - low > size * 1e-12)) return {};
  const double margin = (high - low) * 0.05;
  const Scale scale{low - margin, high + margin};
  std::string svg = fmt::format("<svg viewBox=\"0 0 {} {}\" width=\"{}\" height=\"{}\" role=\"img\">\n", width, height,
                                width, height);
  svg += fmt::format("<title>{}</title>\n", escaped(plot.title));
  svg += label(12.0, 18.0, "heading", cutTo(plot.title, longestTitle));
  for (const double tick : roundTicks(scale.low, scale.high)) {
    svg += line(left, scale.y(tick), right, scale.y(tick), "grid");
    svg += label(left - 6.0, scale.y(tick) + 4.0, "tick", fmt::format("{:.6g}", tick == 0.0 ? 0.0 : tick));
  }
  if (!plot.axis.empty()) {
    svg += fmt::format("<text class=\"axis\" transform=\"translate(12 {:.2f}) rotate(-90)\">{}</text>\n",
                       (top + bottom) / 2.0, escaped(plot.axis));
  }
  for (std::size_t g = 0; g < 2; ++g) {
    const double x = left + (right - left) * (g == 0 ? 0.27 : 0.73);
    svg += label(x, bottom + 17.0, "group", cutTo(plot.groups[g], longestGroup));
    svg += label(x, bottom + 32.0, "group", fmt::format("n = {}", plot.values[g].size()));
    if (!plot.values[g].empty()) svg += group(plot.values[g], x, scale, g == 0 ? "first" : "second");
  }
  if (plot.synthetic) {
    svg += fmt::format("<text class=\"mark\" transform=\"translate({:.2f} {:.2f}) rotate(-30)\">SYNTHETIC</text>\n",
                       (left + right) / 2.0, (top + bottom) / 2.0 + 14.0);
  }
  return svg + "</svg>\n";
}

}  // namespace calot::analytics
