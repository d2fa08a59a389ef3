// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/design/line_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "analytics/report/report_text.h"

namespace calot::analytics {
namespace {

constexpr std::array<Ink, 3> lineInks{Ink::firstLine, Ink::secondLine, Ink::thirdLine};
constexpr std::array<Ink, 3> pointInks{Ink::firstPoint, Ink::secondPoint, Ink::firstPoint};
constexpr std::size_t maxLegend = 18;  // in letters
constexpr double legendHeight = 13.0;

}  // namespace

std::optional<Drawing> drawLines(const LinePlot& plot) {
  std::vector<double> x, y(plot.marks);
  for (const PlotSeries& s : plot.series) {
    for (const auto& [px, py] : s.points) {
      x.push_back(px);
      y.push_back(py);
    }
  }
  const std::optional<PlotScale> across = plotScale(x, plot.frame), scale = plotScale(y, plot.frame);
  if (x.empty() || !across || !scale) return std::nullopt;
  const PlotFrame& frame = plot.frame;
  const auto at = [&](double value) { return across->x(value); };
  Drawing drawing = beginPlot(plot.title, plot.axis, *scale);
  // Attempts are counted: no tick between two.
  const bool whole = std::all_of(x.begin(), x.end(), [](double v) { return v == std::floor(v); });
  for (const double tick : roundTicks(across->low, across->high)) {
    if (whole && tick != std::floor(tick)) continue;
    drawing.text(Ink::count, at(tick), frame.bottom() + 14.0, fmt::format("{:.6g}", tick == 0.0 ? 0.0 : tick));
  }
  drawing.text(Ink::group, (frame.left() + frame.right()) / 2.0, frame.bottom() + 32.0, plot.below);
  for (const double mark : plot.marks)
    drawing.line(Ink::cut, frame.left(), scale->y(mark), frame.right(), scale->y(mark));
  double legend = frame.top() + 8.0;
  for (const PlotSeries& s : plot.series) {
    const std::size_t ink = s.ink < 2 ? s.ink : 2;
    for (std::size_t i = 0; i < s.points.size(); ++i) {
      const auto& [px, py] = s.points[i];
      if (!s.joined) drawing.point(pointInks[ink], at(px), scale->y(py), 2.6);
      if (!s.joined || i == 0) continue;
      const double before = scale->y(s.points[i - 1].second);
      if (s.stepped) {
        drawing.line(lineInks[ink], at(s.points[i - 1].first), before, at(px), before);
        drawing.line(lineInks[ink], at(px), before, at(px), scale->y(py));
      } else {
        drawing.line(lineInks[ink], at(s.points[i - 1].first), before, at(px), scale->y(py));
      }
    }
    if (s.label.empty()) continue;
    drawing.line(lineInks[ink], frame.right() - 110.0, legend - 4.0, frame.right() - 96.0, legend - 4.0);
    drawing.text(Ink::label, frame.right() - 92.0, legend, cutTo(s.label, maxLegend));
    legend += legendHeight;
  }
  endPlot(drawing, plot.synthetic);
  return drawing;
}

}  // namespace calot::analytics
