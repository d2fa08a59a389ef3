// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/history_chart.h"

#include <algorithm>
#include <QtCharts/QLegend>
#include <QtCharts/QLineSeries>
#include <QtCharts/QScatterSeries>
#include <QtCharts/QValueAxis>

#include "gui/dashboard/palette.h"

namespace calot::gui {
namespace {

constexpr int curvePoints = 120;

QScatterSeries* pointsOf(const TraineeHistory& history, bool inCurve) {
  auto* series = new QScatterSeries;
  series->setName(inCurve ? "attempt" : "attempt that is not in the curve");
  series->setMarkerSize(10.0);
  series->setColor(inCurve ? palette::blue : QColor(Qt::white));
  series->setBorderColor(palette::blue);
  for (std::size_t i = 0; i < history.attempts.size(); ++i) {
    const HistoryAttempt& entry = history.attempts[i];
    if (entry.value && entry.why.empty() == inCurve) series->append(static_cast<double>(i + 1), *entry.value);
  }
  return series;
}

QLineSeries* lineOf(const QString& name, const QPen& pen) {
  auto* series = new QLineSeries;
  series->setName(name);
  series->setPen(pen);
  return series;
}

}  // namespace

HistoryChart::HistoryChart(QWidget* parent) : QChartView(parent), watermark_(*scene()) {
  setObjectName("history-chart");
  setRenderHint(QPainter::Antialiasing);
  chart()->setMargins(QMargins(8, 8, 8, 8));
  chart()->legend()->setAlignment(Qt::AlignBottom);
}

void HistoryChart::showHistory(const TraineeHistory& history, const QString& title) {
  chart()->removeAllSeries();
  for (QAbstractAxis* axis : chart()->axes()) {
    chart()->removeAxis(axis);
    delete axis;
  }
  watermark_.setVisible(std::any_of(history.attempts.begin(), history.attempts.end(),
                                    [](const HistoryAttempt& entry) { return entry.attempt->synthetic; }));
  const double last = static_cast<double>(std::max<std::size_t>(1, history.attempts.size()));
  std::vector<QXYSeries*> series;
  if (history.curve) {
    QLineSeries* const curve = lineOf("learning curve a - b / x", QPen(palette::darkText, 1.6));
    for (int i = 0; i <= curvePoints; ++i) {
      const double x = 1.0 + (last - 1.0) * i / curvePoints;
      curve->append(x, history.curve->at(x));
    }
    series.push_back(curve);
  }
  if (history.cut) {
    QLineSeries* const cut = lineOf("norm's cut", QPen(palette::vermillion, 1.4, Qt::DashLine));
    cut->append(0.5, *history.cut);
    cut->append(last + 0.5, *history.cut);
    series.push_back(cut);
  }
  for (const bool inCurve : {true, false}) series.push_back(pointsOf(history, inCurve));
  std::erase_if(series, [](QXYSeries* s) {
    const bool empty = s->count() == 0;
    if (empty) delete s;
    return empty;
  });
  chart()->setTitle(series.empty() ? title + ": nothing to show" : title);
  if (series.empty()) return;

  double low = series[0]->at(0).y(), high = low;
  for (const QXYSeries* s : series) {
    for (const QPointF& point : s->points()) {
      low = std::min(low, point.y());
      high = std::max(high, point.y());
    }
  }
  auto* number = new QValueAxis;
  number->setTitleText("attempt");
  number->setRange(0.5, last + 0.5);
  number->setTickType(QValueAxis::TicksDynamic);
  number->setTickAnchor(1.0);
  number->setTickInterval(last > 20.0 ? 5.0 : 1.0);
  number->setLabelFormat("%.0f");
  auto* value = new QValueAxis;
  value->setTitleText(QString::fromStdString(history.unit));
  const double room = high > low ? 0.08 * (high - low) : std::max(1.0, 0.1 * high);
  const bool fromZero = low >= 0.0 && low < 0.6 * high;
  value->setRange(fromZero ? 0.0 : low - room, high + room);
  value->applyNiceNumbers();
  chart()->addAxis(number, Qt::AlignBottom);
  chart()->addAxis(value, Qt::AlignLeft);
  for (QXYSeries* s : series) {
    chart()->addSeries(s);
    s->attachAxis(number);
    s->attachAxis(value);
  }
}

void HistoryChart::resizeEvent(QResizeEvent* event) {
  QChartView::resizeEvent(event);
  watermark_.place(size());
}

}  // namespace calot::gui
