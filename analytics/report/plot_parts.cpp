// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/plot_parts.h"

#include <fmt/format.h>

#include "analytics/report/box_plot.h"
#include "analytics/report/html_text.h"
#include "analytics/report/text_table.h"

namespace calot::analytics {
namespace {

constexpr std::size_t longestTitle = 42;  // in letters: what has room at the size of page_html.cpp

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

std::string plotLine(double x1, double y1, double x2, double y2, const char* kind) {
  return fmt::format("<line class=\"{}\" x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\"/>\n", kind, x1, y1, x2,
                     y2);
}

std::string plotLabel(double x, double y, const char* kind, const std::string& text) {
  return fmt::format("<text class=\"{}\" x=\"{:.2f}\" y=\"{:.2f}\">{}</text>\n", kind, x, y, escaped(text));
}

std::string plotBegin(const std::string& title, const std::string& axis, const PlotScale& scale) {
  std::string svg = fmt::format("<svg viewBox=\"0 0 {} {}\" width=\"{}\" height=\"{}\" role=\"img\">\n", plotWidth,
                                plotHeight, plotWidth, plotHeight);
  svg += fmt::format("<title>{}</title>\n", escaped(title));
  svg += plotLabel(12.0, 18.0, "heading", cutTo(title, longestTitle));
  for (const double tick : roundTicks(scale.low, scale.high)) {
    svg += plotLine(plotLeft, scale.y(tick), plotRight, scale.y(tick), "grid");
    svg += plotLabel(plotLeft - 6.0, scale.y(tick) + 4.0, "tick", fmt::format("{:.6g}", tick == 0.0 ? 0.0 : tick));
  }
  if (!axis.empty()) {
    svg += fmt::format("<text class=\"axis\" transform=\"translate(12 {:.2f}) rotate(-90)\">{}</text>\n",
                       (plotTop + plotBottom) / 2.0, escaped(axis));
  }
  return svg;
}

std::string plotEnd(bool synthetic) {
  std::string svg;
  if (synthetic) {
    svg += fmt::format("<text class=\"mark\" transform=\"translate({:.2f} {:.2f}) rotate(-30)\">SYNTHETIC</text>\n",
                       (plotLeft + plotRight) / 2.0, (plotTop + plotBottom) / 2.0 + 14.0);
  }
  return svg + "</svg>\n";
}

}  // namespace calot::analytics
