// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/comparison_chart.h"

#include <algorithm>
#include <QFont>
#include <QGraphicsScene>
#include <QtCharts/QBarCategoryAxis>
#include <QtCharts/QBoxPlotSeries>
#include <QtCharts/QBoxSet>
#include <QtCharts/QLegend>
#include <QtCharts/QScatterSeries>
#include <QtCharts/QValueAxis>

namespace calot::gui {
namespace {

// Okabe and Ito's blue and vermillion: told apart by people with any of the common colour-vision deficiencies.
const QColor personColour(0x00, 0x72, 0xb2);
const QColor performerColour(0xd5, 0x5e, 0x00);
constexpr std::size_t maxPoints = 2000;  // of a group; redrawing more takes longer than a frame
constexpr std::size_t fewestForBox = 5;

QBoxPlotSeries* boxesOf(const Comparison& comparison) {
  auto* series = new QBoxPlotSeries;
  series->setName("quartiles and extremes");
  series->setBoxWidth(0.35);
  for (const ComparisonGroup& group : comparison.group) {
    auto* set = new QBoxSet(QString::fromStdString(group.name));
    const bool box = group.point.size() >= fewestForBox;
    set->setValue(QBoxSet::LowerExtreme, box ? group.smallest : group.median);
    set->setValue(QBoxSet::LowerQuartile, box ? group.lowerQuartile : group.median);
    set->setValue(QBoxSet::Median, group.median);
    set->setValue(QBoxSet::UpperQuartile, box ? group.upperQuartile : group.median);
    set->setValue(QBoxSet::UpperExtreme, box ? group.largest : group.median);
    series->append(set);
  }
  series->setBrush(QColor(0xdd, 0xdd, 0xdd));
  series->setPen(QPen(QColor(0x33, 0x33, 0x33), 1.5));
  return series;
}

QScatterSeries* pointsOf(const Comparison& comparison, bool synthetic) {
  auto* series = new QScatterSeries;
  series->setName(synthetic ? "performer (synthetic)" : "attempt");
  series->setMarkerShape(synthetic ? QScatterSeries::MarkerShapeRotatedRectangle : QScatterSeries::MarkerShapeCircle);
  series->setMarkerSize(9.0);
  series->setColor(synthetic ? performerColour : personColour);
  series->setBorderColor(Qt::white);
  for (std::size_t g = 0; g < comparison.group.size(); ++g) {
    const std::vector<ComparisonPoint>& points = comparison.group[g].point;
    const std::size_t stride = 1 + points.size() / maxPoints;
    for (std::size_t i = 0; i < points.size(); i += stride) {
      if (points[i].synthetic != synthetic) continue;
      // Neighbours in value stand at five different places beside the box, always the same ones.
      const double aside = 0.05 * (static_cast<double>(2 * (i / stride) % 5) - 2.0);
      series->append(static_cast<double>(g) + 0.32 + aside, points[i].value);
    }
  }
  return series;
}

}  // namespace

ComparisonChart::ComparisonChart(QWidget* parent) : QChartView(parent), watermark_(*scene()) {
  setRenderHint(QPainter::Antialiasing);
  setObjectName("comparison-chart");
  chart()->setMargins(QMargins(8, 8, 8, 8));
  chart()->legend()->setAlignment(Qt::AlignBottom);
}

void ComparisonChart::showComparison(const Comparison& comparison, const QString& title) {
  chart()->removeAllSeries();
  for (QAbstractAxis* axis : chart()->axes()) {
    chart()->removeAxis(axis);
    delete axis;
  }
  chart()->setTitle(comparison.group.empty() ? title + ": nothing to show" : title);
  watermark_.setVisible(comparison.synthetic);
  if (comparison.group.empty()) return;

  auto* groups = new QBarCategoryAxis;
  double lower = comparison.group.front().smallest, upper = comparison.group.front().largest;
  for (const ComparisonGroup& group : comparison.group) {
    // In two lines: Qt Charts cuts off a long label though there is space.
    groups->append(
        QString("%1<br>n = %2").arg(QString::fromStdString(group.name).toHtmlEscaped()).arg(group.point.size()));
    lower = std::min(lower, group.smallest);
    upper = std::max(upper, group.largest);
  }
  auto* values = new QValueAxis;
  values->setTitleText(QString::fromStdString(comparison.unit));
  const double room = upper > lower ? 0.08 * (upper - lower) : std::max(1.0, 0.1 * upper);
  // Zero is in the picture when it is near: bars of difference look as large as they are.
  const bool fromZero = lower >= 0.0 && lower < 0.6 * upper;
  values->setRange(fromZero ? 0.0 : lower - room, upper + room);
  values->applyNiceNumbers();
  chart()->addAxis(groups, Qt::AlignBottom);
  chart()->addAxis(values, Qt::AlignLeft);

  const auto add = [&](QAbstractSeries* series) {
    chart()->addSeries(series);
    series->attachAxis(groups);
    series->attachAxis(values);
  };
  add(boxesOf(comparison));
  for (const bool synthetic : {false, true}) {
    QScatterSeries* const points = pointsOf(comparison, synthetic);
    if (points->count() > 0)
      add(points);
    else
      delete points;
  }
}

void ComparisonChart::resizeEvent(QResizeEvent* event) {
  QChartView::resizeEvent(event);
  watermark_.place(size());
}

}  // namespace calot::gui
