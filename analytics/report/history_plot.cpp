// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/history_plot.h"

#include <fmt/format.h>

#include "analytics/report/plot_parts.h"

namespace calot::analytics {

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

}  // namespace calot::analytics
