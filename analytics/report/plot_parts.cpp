// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/plot_parts.h"

#include <fmt/format.h>

#include <utility>

#include "analytics/report/box_plot.h"
#include "analytics/report/text_table.h"

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

}  // namespace calot::analytics
