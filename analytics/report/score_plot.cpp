// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/score_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "analytics/report/plot_parts.h"
#include "analytics/report/text_table.h"

namespace calot::analytics {
namespace {

constexpr std::size_t itemsOfDrawing = 13;
constexpr double width = 640.0, barLeft = 130.0, barRight = 570.0, top = 34.0;
constexpr double labelHeight = 18.0, barHeight = 14.0, barApart = 18.0, itemGap = 8.0, legendHeight = 40.0;
constexpr std::size_t maxItem = 100, maxGroup = 20, maxScoreTitle = 90;  // in letters: width available
constexpr int mostNamed = 11;                                            // scores that a legend lists

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
