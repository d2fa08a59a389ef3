// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/history_chart.h"

#include <algorithm>
#include <QtCharts/QAreaSeries>
#include <QtCharts/QLineSeries>

#include "analytics/statistics/expected.h"
#include "gui/attempt/theme.h"
#include "gui/attempt/words.h"

namespace calot::gui {
namespace {

constexpr int curvePoints = 120;

QScatterSeries* historySeries(bool inCurve) {
  auto* series = new QScatterSeries;
  series->setName(inCurve ? "attempt" : "attempt that is not in the curve");
  series->setMarkerSize(11.0);
  series->setColor(inCurve ? theme::first() : theme::surface());
  series->setBorderColor(theme::first());
  return series;
}

std::vector<DotChart::Dot> historyDots(const TraineeHistory& history, bool inCurve) {
  std::vector<DotChart::Dot> dots;
  for (std::size_t i = 0; i < history.attempts.size(); ++i) {
    const HistoryAttempt& entry = history.attempts[i];
    if (!entry.value || entry.why.empty() != inCurve) continue;
    dots.push_back(
        {{static_cast<double>(i + 1), *entry.value},
         QString::fromStdString(entry.attempt->uuid),
         QString("Attempt %1, %2: %3 %4")
             .arg(i + 1)
             .arg(startText(entry.attempt->startUtc), numberText(*entry.value), QString::fromStdString(history.unit))});
  }
  return dots;
}

QLineSeries* lineOf(const QString& name, const QPen& pen) {
  auto* series = new QLineSeries;
  series->setName(name);
  series->setPen(pen);
  return series;
}

}  // namespace

HistoryChart::HistoryChart(QWidget* parent) : DotChart("history-chart", "A figure over the attempts", parent) {}

void HistoryChart::showHistory(const TraineeHistory& history, const QString& title) {
  history_ = history;
  title_ = title;
  redraw();
}

void HistoryChart::redraw() {
  clearChart();
  const double last = static_cast<double>(std::max<std::size_t>(1, history_.attempts.size()));
  std::vector<QLineSeries*> lines;
  QLineSeries *below = nullptr, *above = nullptr;
  if (history_.curve) {
    QLineSeries* const curve = lineOf("learning curve a - b / x", QPen(theme::text(), 1.6));
    below = lineOf({}, QPen(Qt::NoPen));
    above = lineOf({}, QPen(Qt::NoPen));
    for (int i = 0; i <= curvePoints; ++i) {
      const double x = 1.0 + (last - 1.0) * i / curvePoints;
      curve->append(x, history_.curve->at(x));
      const analytics::Expected<analytics::Interval> band = analytics::bandOf(*history_.curve, x);
      if (!band) continue;
      below->append(x, band->lower);
      above->append(x, band->upper);
    }
    lines.push_back(curve);
  }
  if (history_.cut) {
    QLineSeries* const cut = lineOf("norm's cut", QPen(theme::second(), 1.6, Qt::DashLine));
    cut->append(0.5, *history_.cut);
    cut->append(last + 0.5, *history_.cut);
    lines.push_back(cut);
  }
  const std::vector<Dot> inCurve = historyDots(history_, true), others = historyDots(history_, false);
  const bool empty = lines.empty() && inCurve.empty() && others.empty();
  chart()->setTitle(empty ? title_ + ": nothing to show" : title_);
  if (empty) {
    dress(*chart());
    return;
  }
  std::vector<double> heights;
  for (const std::vector<Dot>* dots : {&inCurve, &others}) {
    for (const Dot& dot : *dots) heights.push_back(dot.at.y());
  }
  for (const QLineSeries* line : lines) {
    for (const QPointF& point : line->points()) heights.push_back(point.y());
  }
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  auto* number = new QValueAxis;
  number->setTitleText("attempt");
  number->setRange(0.5, last + 0.5);
  number->setTickType(QValueAxis::TicksDynamic);
  number->setTickAnchor(1.0);
  number->setTickInterval(last > 20.0 ? 5.0 : 1.0);
  number->setLabelFormat("%.0f");
  addAxes(number, valueAxis(*low, *high, QString::fromStdString(history_.unit)));
  if (below != nullptr && below->count() > 0) {
    auto* band = new QAreaSeries(above, below);
    above->setParent(band);
    below->setParent(band);
    band->setName("95 % band of the curve");
    QColor shade = theme::first();
    shade.setAlpha(60);
    band->setBrush(shade);
    band->setPen(QPen(Qt::NoPen));
    addSeries(band);
  } else {
    delete below;
    delete above;
  }
  for (QLineSeries* line : lines) addSeries(line);
  if (!inCurve.empty()) addDots(historySeries(true), inCurve);
  if (!others.empty()) addDots(historySeries(false), others);
  finishChart(std::any_of(history_.attempts.begin(), history_.attempts.end(),
                          [](const HistoryAttempt& entry) { return entry.attempt->synthetic; }));
}

}  // namespace calot::gui
