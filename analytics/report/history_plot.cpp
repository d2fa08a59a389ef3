// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/history_plot.h"

#include <fmt/format.h>

#include "analytics/report/plot_parts.h"

namespace calot::analytics {

std::string historySvg(const HistoryPlot& plot) {
  if (plot.values.size() < 2) return {};
  std::vector<double> all = plot.values;
  if (plot.mark) all.push_back(*plot.mark);
  const std::optional<PlotScale> scale = plotScale(all);
  if (!scale) return {};
  std::string svg = plotBegin(plot.title, plot.axis, *scale);
  if (plot.mark) svg += plotLine(plotLeft, scale->y(*plot.mark), plotRight, scale->y(*plot.mark), "cut");
  const double apart = (plotRight - plotLeft) / static_cast<double>(plot.values.size());
  std::string points;
  for (std::size_t i = 0; i < plot.values.size(); ++i) {
    const double x = plotLeft + apart * (static_cast<double>(i) + 0.5), y = scale->y(plot.values[i]);
    if (i > 0) svg += plotLine(x - apart, scale->y(plot.values[i - 1]), x, y, "whisker");
    points += fmt::format("<circle class=\"point\" cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"3\"/>\n", x, y);
    if (plot.values.size() <= 12) points += plotLabel(x, plotBottom + 17.0, "group", fmt::format("{}", i + 1));
  }
  svg += "<g class=\"first\">\n" + points + "</g>\n";
  svg += plotLabel((plotLeft + plotRight) / 2.0, plotBottom + 32.0, "group", "attempt");
  return svg + plotEnd(plot.synthetic);
}

}  // namespace calot::analytics
