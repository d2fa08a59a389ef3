// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/trace_chart.h"

#include <algorithm>
#include <QGraphicsLineItem>
#include <QMouseEvent>
#include <QtCharts/QLegend>
#include <QtCharts/QLineSeries>
#include <QtCharts/QValueAxis>

#include "gui/dashboard/palette.h"

namespace calot::gui {
namespace {

constexpr double topMargin = 22.0, bottomMargin = 20.0;

}  // namespace

TraceChart::TraceChart(const QString& name, const QString& title, QWidget* parent)
    : QChartView(parent), time_(new QValueAxis), value_(new QValueAxis), cursor_(new QGraphicsLineItem) {
  setObjectName(name);
  setAccessibleName(title);
  setRenderHint(QPainter::Antialiasing);
  setFrameShape(QFrame::NoFrame);
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
  chart()->setMargins(QMargins(0, 0, 0, 0));
  chart()->setBackgroundVisible(false);
  setBackgroundBrush(Qt::white);
  chart()->setTitle(title);
  chart()->legend()->hide();
  chart()->addAxis(time_, Qt::AlignBottom);
  chart()->addAxis(value_, Qt::AlignLeft);
  QFont small = font();
  small.setPointSizeF(0.85 * small.pointSizeF());
  chart()->setTitleFont(small);
  for (QValueAxis* axis : {time_, value_}) {
    axis->setLabelsFont(small);
    axis->setGridLineColor(QColor(0xe4, 0xe4, 0xe4));
  }
  value_->setTickCount(3);
  time_->setLabelFormat("%.0f");
  for (std::size_t h = 0; h < handCount; ++h) {
    series_[h] = new QLineSeries;
    QPen pen(h == 0 ? palette::blue : palette::vermillion, 1.4);
    if (h == 1) pen.setStyle(Qt::DashLine);
    pen.setCosmetic(true);
    series_[h]->setPen(pen);
    chart()->addSeries(series_[h]);
    series_[h]->attachAxis(time_);
    series_[h]->attachAxis(value_);
  }
  cursor_->setPen(QPen(Qt::black, 1.5));
  cursor_->setZValue(50.0);
  scene()->addItem(cursor_);
  clear();
}

void TraceChart::setTraces(double seconds, double bin, const std::array<std::vector<double>, handCount>& values) {
  seconds_ = seconds;
  double largest = 0.0;
  for (std::size_t h = 0; h < handCount; ++h) {
    QList<QPointF> points;
    points.reserve(static_cast<qsizetype>(values[h].size()));
    for (std::size_t i = 0; i < values[h].size(); ++i) {
      points.append({std::min(seconds, (static_cast<double>(i) + 0.5) * bin), values[h][i]});
      largest = std::max(largest, values[h][i]);
    }
    series_[h]->replace(points);
  }
  time_->setRange(0.0, std::max(seconds, 0.1));
  time_->setTickType(QValueAxis::TicksDynamic);
  time_->setTickInterval(seconds > 240.0 ? 60.0 : seconds > 60.0 ? 20.0 : seconds > 20.0 ? 5.0 : 1.0);
  value_->setTickType(QValueAxis::TicksFixed);
  value_->setRange(0.0, largest > 0.0 ? largest : 1.0);
  value_->applyNiceNumbers();
  // Room above the highest tick: the chart leaves out a label that touches its border.
  const double top = value_->max();
  value_->setTickType(QValueAxis::TicksDynamic);
  value_->setTickInterval(0.5 * top);
  value_->setRange(0.0, 1.15 * top);
  value_->setLabelFormat(top < 1.0 ? "%.2f" : top < 10.0 ? "%.1f" : "%.0f");
  place();
}

void TraceChart::clear() {
  setTraces(0.0, 1.0, {});
  cursor_->hide();
}

void TraceChart::setPosition(double time) {
  position_ = time;
  place();
}

void TraceChart::place() {
  const TimeScale s = scale();
  const double height = viewport()->height() - topMargin - bottomMargin;
  cursor_->setVisible(seconds_ > 0.0);
  cursor_->setLine(s.x(position_), topMargin, s.x(position_), topMargin + height);
}

void TraceChart::resizeEvent(QResizeEvent* event) {
  QChartView::resizeEvent(event);
  chart()->resize(viewport()->size());
  chart()->setPlotArea(QRectF(TimeScale::leftMargin, topMargin, scale().span(),
                              std::max(10.0, viewport()->height() - topMargin - bottomMargin)));
  place();
}

void TraceChart::mousePressEvent(QMouseEvent* event) {
  if (seconds_ > 0.0 && event->button() == Qt::LeftButton) emit timeChosen(scale().time(event->position().x()));
}

void TraceChart::mouseMoveEvent(QMouseEvent* event) {
  if (seconds_ > 0.0 && event->buttons().testFlag(Qt::LeftButton)) emit timeChosen(scale().time(event->position().x()));
}

}  // namespace calot::gui
