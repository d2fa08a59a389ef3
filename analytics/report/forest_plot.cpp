// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/forest_plot.h"

#include <fmt/format.h>

#include <cassert>

#include "analytics/report/plot_parts.h"
#include "analytics/report/text_table.h"

namespace calot::analytics {
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

}  // namespace calot::analytics
