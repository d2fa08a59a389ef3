// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/roc_chart.h"

#include <QEvent>
#include <QtCharts/QLegend>
#include <QtCharts/QLineSeries>
#include <QtCharts/QValueAxis>

#include "gui/attempt/theme.h"
#include "gui/dashboard/chart_dress.h"
#include "gui/dashboard/palette.h"

namespace calot::gui {

RocChart::RocChart(QWidget* parent) : QChartView(parent) {
  setObjectName("roc-chart");
  setAccessibleName("Receiver operating characteristic");
  setRenderHint(QPainter::Antialiasing);
  chart()->setMargins(QMargins(8, 8, 8, 8));
  chart()->legend()->hide();
}

void RocChart::clear(const QString& title) {
  chart()->removeAllSeries();
  for (QAbstractAxis* axis : chart()->axes()) {
    chart()->removeAxis(axis);
    delete axis;
  }
  chart()->setTitle(title);
  dress(*chart());
}

void RocChart::showCurve(const RocCurve& curve, const QString& title) {
  clear(title);
  auto* across = new QValueAxis;
  auto* up = new QValueAxis;
  across->setTitleText("share of the second group taken for the first");
  up->setTitleText("share of the first group found");
  for (QValueAxis* axis : {across, up}) {
    axis->setRange(0.0, 1.0);
    axis->setTickCount(6);
    axis->setLabelFormat("%.1f");
  }
  chart()->addAxis(across, Qt::AlignBottom);
  chart()->addAxis(up, Qt::AlignLeft);
  const auto add = [&](const QPen& pen) {
    auto* series = new QLineSeries;
    series->setPen(pen);
    chart()->addSeries(series);
    series->attachAxis(across);
    series->attachAxis(up);
    return series;
  };
  QLineSeries* const chance = add(QPen(palette::grey, 1.2, Qt::DashLine));
  chance->append(0.0, 0.0);
  chance->append(1.0, 1.0);
  QLineSeries* const line = add(QPen(theme::first(), 2.2));
  for (const RocPoint& point : curve.points) line->append(point.falsePositive, point.truePositive);
  dress(*chart());
}

void RocChart::changeEvent(QEvent* event) {
  QChartView::changeEvent(event);
  if (event->type() == QEvent::PaletteChange || event->type() == QEvent::FontChange) dress(*chart());
}

}  // namespace calot::gui
