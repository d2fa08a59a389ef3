// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/mark_slider.h"

#include <algorithm>
#include <cmath>
#include <QLocale>
#include <QMouseEvent>
#include <QPainter>
#include <QSignalBlocker>
#include <QWheelEvent>

#include "analytics/report/plots.h"
#include "gui/attempt/widget_parts.h"

namespace calot::gui {
namespace {

constexpr double margin = 0.08;  // of the range, on both sides of the values
constexpr double leastSteps = 100.0;
constexpr double dotRadius = 3.2, handle = 5.0;  // pixels, for letters of the usual size
constexpr int pages = 10;                        // of Page Up from end to end

const char* const lanes[] = {"competent", "others"};

}  // namespace

MarkScale::MarkScale(const std::vector<double>& values, bool whole) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  double low = values.empty() ? 0.0 : *least, high = values.empty() ? 1.0 : *most;
  const double range = high > low ? high - low : std::max(1.0, std::abs(high));
  high += whole ? std::max(1.0, std::ceil(margin * range)) : margin * range;
  low = low >= 0.0 ? std::max(0.0, low - margin * range) : low - margin * range;
  if (whole && high - low <= 1000.0) {
    low = std::floor(low);
  } else {
    const double finest = (high - low) / leastSteps;
    exponent_ = static_cast<int>(std::floor(std::log10(finest)));
    const double fine = finest / std::pow(10.0, exponent_);
    multiple_ = fine >= 5.0 ? 5.0 : fine >= 2.0 ? 2.0 : 1.0;
  }
  const double step = multiple_ * std::pow(10.0, exponent_);
  first_ = std::floor(low / step);
  steps_ = std::max(1, static_cast<int>(std::ceil(high / step) - first_));
}

double MarkScale::at(int position) const {
  const double steps = (first_ + position) * multiple_;
  // Dividing by a power of ten gives the nearest number to what its decimals say.
  return exponent_ < 0 ? steps / std::pow(10.0, -exponent_) : steps * std::pow(10.0, exponent_);
}

int MarkScale::nearest(double value) const {
  const double position = std::round(value / (multiple_ * std::pow(10.0, exponent_)) - first_);
  return static_cast<int>(std::clamp(position, 0.0, static_cast<double>(steps_)));
}

MarkSlider::MarkSlider(const QString& name, const QString& spokenName) : QSlider(Qt::Horizontal) {
  setObjectName(name);
  setAccessibleName(spokenName);
  setFocusPolicy(Qt::StrongFocus);
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
}

void MarkSlider::show(View view) {
  const QSignalBlocker quiet(this);
  view_ = std::move(view);
  update();
  if (isSliderDown()) return;  // the axis stays as it is beneath the hand
  std::vector<double> values{view_.mark.value_or(view_.start)};
  if (view_.before) values.push_back(*view_.before);
  for (const Dot& dot : view_.dots) values.push_back(dot.value);
  scale_ = MarkScale(values, view_.whole);
  setRange(0, scale_.steps());
  setSingleStep(1);
  setPageStep(std::max(1, scale_.steps() / pages));
  setValue(scale_.nearest(view_.mark.value_or(view_.start)));
}

QSize MarkSlider::sizeHint() const { return {theme::inType(300), 3 * fontMetrics().height() + theme::inType(8)}; }

double MarkSlider::left() const {
  return 12.0 + std::max(fontMetrics().horizontalAdvance(lanes[0]), fontMetrics().horizontalAdvance(lanes[1]));
}

double MarkSlider::right() const { return width() - 14.0; }

double MarkSlider::placeOf(double value) const {
  const double low = scale_.at(0), high = scale_.at(scale_.steps());
  return left() + (value - low) / (high - low) * (right() - left());
}

void MarkSlider::moveTo(double pixel) {
  const double share = (pixel - left()) / std::max(1.0, right() - left());
  setValue(static_cast<int>(std::lround(std::clamp(share, 0.0, 1.0) * scale_.steps())));
}

void MarkSlider::mousePressEvent(QMouseEvent* event) {
  if (event->button() != Qt::LeftButton) return;
  setSliderDown(true);
  moveTo(event->position().x());
}

void MarkSlider::mouseMoveEvent(QMouseEvent* event) {
  if (isSliderDown()) moveTo(event->position().x());
}

void MarkSlider::mouseReleaseEvent(QMouseEvent*) { setSliderDown(false); }

// Scrolling past a slider must not change it.
void MarkSlider::wheelEvent(QWheelEvent* event) { event->ignore(); }

void MarkSlider::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.fillRect(rect(), theme::surface());
  const double lane = fontMetrics().height(), bottom = 2.0 * lane + theme::inType(4);
  const double low = scale_.at(0), high = scale_.at(scale_.steps()), scale = theme::typeScale();
  const std::optional<double> mark = isSliderDown() ? std::optional(markedValue()) : view_.mark;
  if (mark) {  // the side that passes
    QColor ground = theme::first();
    ground.setAlphaF(0.14F);
    const double at = placeOf(*mark);
    painter.fillRect(
        view_.lowerIsBetter ? QRectF(left(), 0.0, at - left(), bottom) : QRectF(at, 0.0, right() - at, bottom), ground);
  }
  painter.setPen(theme::muted());
  for (int i = 0; i < 2; ++i)
    painter.drawText(QRectF(4.0, i * lane + 2.0, left() - 8.0, lane), Qt::AlignVCenter | Qt::AlignLeft, lanes[i]);
  painter.drawLine(QPointF(left(), bottom), QPointF(right(), bottom));
  double free = left() - 20.0;  // labels do not touch each other
  for (const double tick : analytics::roundTicks(low, high)) {
    const QString text = QLocale().toString(tick, 'g', 6);
    const double x = placeOf(tick), half = 0.5 * fontMetrics().horizontalAdvance(text);
    painter.drawLine(QPointF(x, bottom), QPointF(x, bottom + 3.0));
    if (x - half < free || x + half > width()) continue;
    painter.drawText(QRectF(x - half, bottom + 3.0, 2.0 * half + 1.0, lane), Qt::AlignCenter, text);
    free = x + half + 8.0;
  }
  // Equal values stand above each other by a little.
  for (std::size_t i = 0; i < view_.dots.size(); ++i) {
    const Dot& dot = view_.dots[i];
    const double y = (dot.competent ? 0.5 : 1.5) * lane + 2.0 + (static_cast<double>(i % 3) - 1.0) * 2.2 * scale;
    painter.setPen(QPen(dot.competent ? theme::first() : theme::second(), 1.5));
    painter.setBrush(dot.competent ? QBrush(theme::first()) : QBrush(Qt::NoBrush));
    painter.drawEllipse(QPointF(placeOf(dot.value), y), dotRadius * scale, dotRadius * scale);
  }
  painter.setBrush(theme::text());
  if (view_.before) {
    painter.setPen(QPen(theme::muted(), 1.5, Qt::DashLine));
    painter.drawLine(QPointF(placeOf(*view_.before), 0.0), QPointF(placeOf(*view_.before), bottom));
  }
  if (mark || isEnabled()) {
    const double at = mark ? placeOf(*mark) : placeOf(scale_.at(value()));
    painter.setPen(QPen(mark ? theme::text() : theme::muted(), 2.0, mark ? Qt::SolidLine : Qt::DotLine));
    painter.drawLine(QPointF(at, 0.0), QPointF(at, bottom));
    painter.setPen(Qt::NoPen);
    painter.setBrush(mark ? theme::text() : theme::muted());
    const double h = handle * scale;
    if (isEnabled()) painter.drawPolygon(QPolygonF({{at - h, 0.0}, {at + h, 0.0}, {at, 1.5 * h}}));
  }
  if (!hasFocus()) return;
  painter.setBrush(Qt::NoBrush);
  painter.setPen(QPen(palette().color(QPalette::Highlight), 2.0));
  painter.drawRect(rect().adjusted(1, 1, -1, -1));
}

}  // namespace calot::gui
