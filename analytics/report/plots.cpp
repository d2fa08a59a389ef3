// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/report/plots.h"

#include <fmt/format.h>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "analytics/report/report_document.h"
#include "analytics/statistics/descriptive.h"

namespace calot::analytics {
namespace {

constexpr double titleLetter = 7.5;   // mean width of a heading's letter
constexpr double legendLetter = 6.0;  // of a label's

}  // namespace

std::optional<PlotScale> plotScale(std::span<const double> values, const PlotFrame& frame) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const double v : values) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  const double size = std::max(std::abs(low), std::abs(high)), least = low >= 0.0 && low < high ? 0.0 : -HUGE_VAL;
  if (!(low <= high) || size > 1e300) return std::nullopt;
  if (low == high) {
    const double around = size > 0.0 ? size * 0.1 : 1.0;
    low -= around;
    high += around;
  }
  if (!(high - low > size * 1e-12)) return std::nullopt;
  const double margin = (high - low) * 0.05;
  return PlotScale{std::max(least, low - margin), high + margin, frame};
}

Drawing beginPlot(const std::string& title, const std::string& axis, const PlotScale& scale) {
  const PlotFrame& frame = scale.frame;
  Drawing drawing{title, frame.width, frame.height, {}};
  drawing.text(Ink::heading, 12.0, 18.0, cutTo(title, static_cast<std::size_t>(frame.width / titleLetter)));
  for (const double tick : roundTicks(scale.low, scale.high)) {
    drawing.line(Ink::grid, frame.left(), scale.y(tick), frame.right(), scale.y(tick));
    drawing.text(Ink::tick, frame.left() - 6.0, scale.y(tick) + 4.0, fmt::format("{:.6g}", tick == 0.0 ? 0.0 : tick));
  }
  if (!axis.empty()) drawing.text(Ink::axis, 12.0, (frame.top() + frame.bottom()) / 2.0, axis, -90.0);
  return drawing;
}

void endPlot(Drawing& drawing, bool synthetic) {
  if (!synthetic) return;
  drawing.text(Ink::watermark, drawing.width / 2.0, drawing.height / 2.0 + 14.0, "SYNTHETIC", -30.0);
}

void drawLegend(Drawing& drawing, const PlotFrame& frame, const std::vector<LegendEntry>& entries) {
  const double y = frame.height - 8.0;
  double x = frame.left();
  for (const auto& [ink, label] : entries) {
    if (styleOf(ink).letters == 0.0 && *styleOf(ink).fill == '\0')
      drawing.line(ink, x, y - 4.0, x + 14.0, y - 4.0);
    else if (ink == Ink::band)
      drawing.box(ink, x, y - 8.0, 14.0, 8.0);
    else
      drawing.point(ink, x + 9.0, y - 4.0, 4.0);
    drawing.text(Ink::label, x + 18.0, y, label);
    x += 34.0 + legendLetter * static_cast<double>(label.size());
  }
}

namespace {

constexpr std::size_t maxGroup = 20;     // in letters
constexpr std::size_t minBox = 5;        // values: quartiles of fewer are interpolations between two of them
constexpr std::size_t mostPoints = 200;  // drawn of a group: more are one dark column, and a report of megabytes
constexpr double usualBoxHalf = 26.0, pointRadius = 2.6;
constexpr double countLetter = 4.9, groupLetter = 6.5,
                 minName = 4.0;  // mean width of a letter; a name of fewer says nothing

/// Position and inks of a group's column.
struct BoxColumn {
  double x, boxHalf;
  Ink box, point;
};

void drawBox(Drawing& drawing, const std::vector<double>& sorted, const BoxColumn& column, const PlotScale& scale) {
  const double q1 = quantileOfSorted(sorted, 0.25), q2 = quantileOfSorted(sorted, 0.5),
               q3 = quantileOfSorted(sorted, 0.75);
  const double reach = 1.5 * (q3 - q1);
  const double lower = std::min(q1, *std::lower_bound(sorted.begin(), sorted.end(), q1 - reach));
  const double upper = std::max(q3, *(std::upper_bound(sorted.begin(), sorted.end(), q3 + reach) - 1));
  const auto& [x, boxHalf, boxInk, pointInk] = column;
  drawing.line(Ink::whisker, x, scale.y(lower), x, scale.y(q1));
  drawing.line(Ink::whisker, x, scale.y(q3), x, scale.y(upper));
  drawing.line(Ink::whisker, x - boxHalf / 2, scale.y(lower), x + boxHalf / 2, scale.y(lower));
  drawing.line(Ink::whisker, x - boxHalf / 2, scale.y(upper), x + boxHalf / 2, scale.y(upper));
  drawing.box(boxInk, x - boxHalf, scale.y(q3), 2 * boxHalf, std::max(0.0, scale.y(q1) - scale.y(q3)));
  drawing.line(Ink::median, x - boxHalf, scale.y(q2), x + boxHalf, scale.y(q2));
}

/// Every value is drawn, or every n-th of them in order.
std::size_t strideOf(std::size_t values) { return values == 0 ? 1 : 1 + (values - 1) / mostPoints; }

void drawGroup(Drawing& drawing, const BoxPlot& plot, std::size_t group, const BoxColumn& column,
               const PlotScale& scale) {
  const std::span<const double> values = plot.values[group];
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> sorted;
  sorted.reserve(values.size());
  for (const std::size_t i : order) sorted.push_back(values[i]);
  if (sorted.size() >= minBox) drawBox(drawing, sorted, column, scale);
  const auto draw = [&](std::size_t i, std::size_t place) {
    // Side by side in five places in turn, so that equal values do not hide each other.
    const double x = column.x + (static_cast<double>(place * 2 % 5) - 2.0) * column.boxHalf * (7.0 / usualBoxHalf);
    const double y = scale.y(sorted[i]);
    const BoxPlot::Point point = plot.point ? plot.point(group, order[i]) : BoxPlot::Point{};
    drawing.point(point.synthetic ? Ink::hollowPoint : column.point, x, y, pointRadius);
    if (!point.key.empty()) drawing.marks.push_back({x, y, point.key, point.text});
  };
  const std::size_t stride = strideOf(sorted.size());
  for (std::size_t i = 0; i + 1 < sorted.size(); i += stride) draw(i, i / stride);
  draw(sorted.size() - 1, (sorted.size() - 1) / stride);  // both extremes, always
}

void nameGroup(Drawing& drawing, const BoxPlot& plot, std::size_t group, double x, double width) {
  const double letters = width / groupLetter, bottom = plot.frame.bottom();
  if (letters < minName || group >= plot.groups.size()) return;
  const std::size_t n = plot.values[group].size(), stride = strideOf(n);
  drawing.text(Ink::group, x, bottom + 17.0,
               cutTo(plot.groups[group], std::min(maxGroup, static_cast<std::size_t>(letters))));
  std::string count = fmt::format("n = {}", n);
  if (stride > 1) count += fmt::format(", one in {} drawn", stride);
  if (static_cast<double>(count.size()) * countLetter < width) drawing.text(Ink::group, x, bottom + 32.0, count);
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
  const std::optional<PlotScale> scale = plotScale(all, plot.frame);
  if (!scale) return std::nullopt;
  Drawing drawing = beginPlot(plot.title, plot.axis, *scale);
  const double apart = (plot.frame.right() - plot.frame.left()) / static_cast<double>(plot.values.size());
  for (std::size_t g = 0; g < plot.values.size(); ++g) {
    const BoxColumn column{plot.frame.left() + apart * (static_cast<double>(g) + 0.5),
                           std::min(std::max(usualBoxHalf, 0.12 * apart), 0.35 * apart),
                           g % 2 == 0 ? Ink::firstBox : Ink::secondBox,
                           g % 2 == 0 ? Ink::firstPoint : Ink::secondPoint};
    nameGroup(drawing, plot, g, column.x, apart);
    if (!plot.values[g].empty()) drawGroup(drawing, plot, g, column, *scale);
  }
  if (plot.frame.legend) {
    std::vector<LegendEntry> legend{{Ink::firstPoint, "attempt"}};
    if (plot.synthetic) legend.push_back({Ink::hollowPoint, "performer (synthetic)"});
    drawLegend(drawing, plot.frame, legend);
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

namespace {

constexpr int curveParts = 480;
constexpr double historyRadius = 3.0;

/// Points of the curve and its band over attempts 1 to `last`.
struct CurvePart {
  double x, y;
  Interval band;
};
std::vector<CurvePart> curvePartsOf(const LearningCurve& curve, double last) {
  std::vector<CurvePart> parts;
  for (int i = 0; i <= curveParts; ++i) {
    const double x = 1.0 + (last - 1.0) * i / curveParts;
    parts.push_back({x, curve.at(x), bandOf(curve, x)});
  }
  return parts;
}

}  // namespace

std::optional<Drawing> drawHistory(const HistoryPlot& plot) {
  const double last = std::max(1.0, plot.attempts > 0.0 ? plot.attempts : static_cast<double>(plot.values.size()));
  std::vector<CurvePart> curve;
  if (plot.curve != nullptr) curve = curvePartsOf(*plot.curve, last);
  std::vector<double> all;
  for (const HistoryPlot::Value& v : plot.values) all.push_back(v.value);
  for (const CurvePart& p : curve) all.push_back(p.y);
  if (plot.mark) all.push_back(*plot.mark);
  const std::optional<PlotScale> scale = plotScale(all, plot.frame);
  if (!scale) return std::nullopt;
  const PlotFrame& frame = plot.frame;
  Drawing drawing = beginPlot(plot.title, plot.axis, *scale);
  const double apart = (frame.right() - frame.left()) / last;
  const auto x = [&](double attempt) { return frame.left() + apart * (attempt - 0.5); };
  const auto y = [&](double value) { return std::clamp(scale->y(value), frame.top(), frame.bottom()); };
  std::vector<LegendEntry> legend{{Ink::firstPoint, "attempt"}};
  // Boxes overlap: their edges would show.
  for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
    const Interval& band = curve[i].band;
    drawing.box(Ink::band, x(curve[i].x), y(band.upper), x(curve[i + 1].x) - x(curve[i].x) + 1.0,
                y(band.lower) - y(band.upper));
  }
  for (std::size_t i = 1; i < curve.size(); ++i)
    drawing.line(Ink::secondLine, x(curve[i - 1].x), y(curve[i - 1].y), x(curve[i].x), y(curve[i].y));
  if (!curve.empty()) legend.push_back({Ink::secondLine, "learning curve a - b / x"});
  if (!curve.empty()) legend.push_back({Ink::band, "95 % band of the curve"});
  if (plot.mark) {
    drawing.line(Ink::cut, frame.left(), y(*plot.mark), frame.right(), y(*plot.mark));
    legend.push_back({Ink::cut, "norm's cut"});
  }
  for (std::size_t i = 1; i < plot.values.size() && curve.empty(); ++i)
    drawing.line(Ink::whisker, x(plot.values[i - 1].attempt), y(plot.values[i - 1].value), x(plot.values[i].attempt),
                 y(plot.values[i].value));
  for (const HistoryPlot::Value& v : plot.values) {
    drawing.point(v.outside ? Ink::hollowPoint : Ink::firstPoint, x(v.attempt), y(v.value), historyRadius);
    if (!v.key.empty()) drawing.marks.push_back({x(v.attempt), y(v.value), v.key, v.text});
  }
  if (std::any_of(plot.values.begin(), plot.values.end(), [](const auto& v) { return v.outside; }))
    legend.push_back({Ink::hollowPoint, "attempt that is not in the curve"});
  const double every = std::max(1.0, std::ceil(20.0 / apart));
  for (double n = 1.0; n <= last; n += every)
    drawing.text(Ink::group, x(n), frame.bottom() + 17.0, fmt::format("{:.0f}", n));
  drawing.text(Ink::group, (frame.left() + frame.right()) / 2.0, frame.bottom() + 32.0, "attempt");
  if (frame.legend) drawLegend(drawing, frame, legend);
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
