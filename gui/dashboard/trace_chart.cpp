// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/trace_chart.h"

#include <algorithm>
#include <cmath>
#include <QEvent>
#include <QLocale>
#include <QMouseEvent>
#include <QPainter>
#include <utility>

#include "gui/attempt/theme.h"

namespace calot::gui {
namespace {

double topMargin() { return theme::inType(18); }
double bottomMargin() { return theme::inType(16); }
constexpr double headroom = 1.15;  // of the highest number, so that a line along it is seen

double timeInterval(double seconds) {
  if (seconds > 240.0) return 60.0;
  if (seconds > 60.0) return 20.0;
  return seconds > 20.0 ? 5.0 : 1.0;
}

}  // namespace

double axisTop(double largest) {
  if (largest <= 0.0) return 1.0;
  const double power = std::pow(10.0, std::floor(std::log10(largest)));
  for (const double factor : {1.0, 2.0, 4.0, 5.0, 8.0}) {
    if (largest <= factor * power * (1.0 + 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

TraceChart::TraceChart(const QString& name, QString title, QWidget* parent)
    : QWidget(parent), title_(std::move(title)) {
  setObjectName(name);
  setAccessibleName(title_);
  setAttribute(Qt::WA_OpaquePaintEvent);
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Preferred);
  QFont small = font();
  small.setPointSizeF(0.85 * small.pointSizeF());
  setFont(small);
}

void TraceChart::setTraces(double seconds, double bin, std::array<std::vector<double>, handCount> values) {
  seconds_ = seconds;
  bin_ = bin;
  values_ = std::move(values);
  double largest = 0.0;
  for (const std::vector<double>& trace : values_) {
    for (const double value : trace) largest = std::max(largest, value);
  }
  top_ = axisTop(largest);
  painted_ = {};
  update();
}

void TraceChart::setPosition(double time) {
  if (time == position_) return;
  position_ = time;
  update();
}

QRectF TraceChart::plot() const {
  // Its bottom is the middle of a row of pixels: a hand at rest is one clear line.
  return {TimeScale::leftMargin(), topMargin(), scale().span(),
          std::max(10.0, height() - topMargin() - bottomMargin() - 0.5)};
}

void TraceChart::paintAxes(QPainter& painter) const {
  const QRectF box = plot();
  painter.setPen(theme::text());
  painter.drawText(QRectF(0, 0, width(), topMargin()), Qt::AlignCenter, title_);
  const QPen grid(theme::grid(), 1.0);
  const int decimals = top_ < 1.0 ? 2 : top_ < 10.0 ? 1 : 0;
  for (const double share : {0.0, 0.5, 1.0}) {
    const double y = box.bottom() - share / headroom * box.height();
    painter.setPen(grid);
    painter.drawLine(QPointF(box.left(), y), QPointF(box.right(), y));
    painter.setPen(theme::text());
    painter.drawText(QRectF(0, y - 10.0, box.left() - 6.0, 20.0), Qt::AlignRight | Qt::AlignVCenter,
                     QLocale().toString(share * top_, 'f', decimals));
  }
  if (seconds_ <= 0.0) return;
  const double interval = timeInterval(seconds_);
  for (int n = 0; n * interval <= seconds_; ++n) {
    const double x = scale().x(n * interval);
    painter.setPen(grid);
    painter.drawLine(QPointF(x, box.top()), QPointF(x, box.bottom()));
    painter.setPen(theme::text());
    painter.drawText(QRectF(x - 40.0, box.bottom(), 80.0, bottomMargin()), Qt::AlignCenter,
                     QLocale().toString(n * interval, 'f', 0));
  }
}

void TraceChart::paintTrace(QPainter& painter, std::size_t hand) const {
  const QRectF box = plot();
  QPolygonF line;
  line.reserve(static_cast<qsizetype>(values_[hand].size()));
  for (std::size_t i = 0; i < values_[hand].size(); ++i) {
    const double time = std::min(seconds_, (static_cast<double>(i) + 0.5) * bin_);
    line.append({scale().x(time), box.bottom() - values_[hand][i] / (headroom * top_) * box.height()});
  }
  // Qt strokes lines of a pixel twenty times as fast as wider ones.
  QPen pen(hand == 0 ? theme::first() : theme::second(), 1.0);
  pen.setCosmetic(true);
  if (hand == 1) pen.setStyle(Qt::DashLine);
  painter.setPen(pen);
  painter.drawPolyline(line);
}

void TraceChart::paintEvent(QPaintEvent*) {
  if (painted_.isNull()) {
    const double ratio = devicePixelRatioF();
    painted_ = QPixmap((QSizeF(size()) * ratio).toSize());
    painted_.setDevicePixelRatio(ratio);
    painted_.fill(theme::surface());
    QPainter painter(&painted_);
    painter.setFont(font());
    paintAxes(painter);
    painter.setRenderHint(QPainter::Antialiasing);
    for (std::size_t hand = 0; hand < handCount; ++hand) paintTrace(painter, hand);
  }
  QPainter painter(this);
  painter.drawPixmap(0, 0, painted_);
  if (seconds_ <= 0.0) return;
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(QPen(theme::text(), 1.5));
  const double x = std::floor(scale().x(position_)) + 0.5;  // one black column, not two grey ones
  painter.drawLine(QPointF(x, plot().top()), QPointF(x, plot().bottom()));
}

void TraceChart::resizeEvent(QResizeEvent*) { painted_ = {}; }

void TraceChart::changeEvent(QEvent* event) {
  QWidget::changeEvent(event);
  if (event->type() == QEvent::PaletteChange) painted_ = {};
}

void TraceChart::mousePressEvent(QMouseEvent* event) {
  if (seconds_ > 0.0 && event->button() == Qt::LeftButton) emit timeChosen(scale().time(event->position().x()));
}

void TraceChart::mouseMoveEvent(QMouseEvent* event) {
  if (seconds_ > 0.0 && event->buttons().testFlag(Qt::LeftButton)) emit timeChosen(scale().time(event->position().x()));
}

}  // namespace calot::gui
