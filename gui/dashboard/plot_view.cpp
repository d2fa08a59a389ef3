// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/plot_view.h"

#include <algorithm>
#include <QApplication>
#include <QEvent>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QToolTip>
#include <tuple>
#include <utility>

#include "gui/attempt/widget_parts.h"
#include "gui/report/drawing_painter.h"

namespace calot::gui {
namespace {

constexpr double usualScale = 1.15;  // pixels of a unit: letters of 11 units are as high as a label's
constexpr double leastWidth = 300;   // units: a smaller plot would cut its letters off
constexpr double markReach = 8.0;    // pixels from a mark that still count as on it
constexpr double ring = 9.0;         // pixels: radius around the chosen mark

}  // namespace

QColor onScreen(const QColor& colour) {
  if (!theme::dark()) return colour == QColor(Qt::white) ? theme::surface() : colour;
  // White becomes the ground, black nearly white; what stood out from white paper stands out as far.
  float hue = 0.0F, saturation = 0.0F, lightness = 0.0F;
  colour.getHslF(&hue, &saturation, &lightness);
  const float ground = static_cast<float>(theme::surface().lightnessF());
  return QColor::fromHslF(std::max(0.0F, hue), saturation, ground + (0.96F - ground) * (1.0F - lightness));
}

PlotView::PlotView(const char* name, const char* spokenName) {
  setObjectName(name);
  setAccessibleName(spokenName);
  setFocusPolicy(Qt::StrongFocus);
  setMouseTracking(true);
  setAttribute(Qt::WA_OpaquePaintEvent);
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Expanding);
}

void PlotView::show(const QString& title, Draw draw, bool synthetic) {
  title_ = title;
  draw_ = std::move(draw);
  synthetic_ = synthetic;
  chosen_ = -1;
  drawing_.reset();
  painted_ = {};
  update();
}

void PlotView::keepHeight(double units) {
  leastHeight_ = units;
  setFixedHeight(static_cast<int>(std::ceil(usualScale * theme::typeScale() * units)));
}

double PlotView::pixelsPerUnit() const {
  return std::min({usualScale * theme::typeScale(), width() / leastWidth, height() / leastHeight_});
}

const analytics::Drawing& PlotView::drawing() {
  if (drawing_) return *drawing_;
  const double scale = std::max(1e-3, pixelsPerUnit());
  const analytics::PlotFrame frame{width() / scale, height() / scale};
  if (draw_) drawing_ = draw_(frame);
  if (!drawing_) {
    drawing_ = analytics::Drawing{title_.toStdString(), frame.width, frame.height, {}};
    drawing_->text(analytics::Ink::heading, 12.0, 18.0, title_.toStdString());
  }
  auto& marks = drawing_->marks;
  std::sort(marks.begin(), marks.end(),
            [](const auto& a, const auto& b) { return std::tie(a.x, a.y, a.key) < std::tie(b.x, b.y, b.key); });
  return *drawing_;
}

QPointF PlotView::placeOf(const analytics::DrawnMark& mark) const { return QPointF(mark.x, mark.y) * pixelsPerUnit(); }

const analytics::DrawnMark* PlotView::markAt(const QPointF& place) {
  const analytics::DrawnMark* nearest = nullptr;
  double best = markReach;
  for (const analytics::DrawnMark& mark : marks()) {
    const QPointF away = placeOf(mark) - place;
    const double distance = std::hypot(away.x(), away.y());
    if (distance > best) continue;
    best = distance;
    nearest = &mark;
  }
  return nearest;
}

void PlotView::choose(int mark) {
  chosen_ = mark;
  const analytics::DrawnMark& shown = marks()[static_cast<std::size_t>(mark)];
  const QString text = QString::fromStdString(shown.text);
  setAccessibleDescription(text);
  QToolTip::showText(mapToGlobal(placeOf(shown).toPoint()), text, this);
  update();
}

void PlotView::paintEvent(QPaintEvent*) {
  if (painted_.isNull()) {
    const double ratio = devicePixelRatioF();
    painted_ = QPixmap((QSizeF(size()) * ratio).toSize());
    painted_.setDevicePixelRatio(ratio);
    painted_.fill(theme::surface());
    QPainter painter(&painted_);
    painter.setRenderHint(QPainter::Antialiasing);
    paintDrawing(painter, drawing(), rect(), {QApplication::font(), onScreen});
  }
  QPainter painter(this);
  painter.drawPixmap(0, 0, painted_);
  painter.setRenderHint(QPainter::Antialiasing);
  if (chosen_ >= 0) {
    painter.setPen(QPen(theme::text(), 1.5));
    painter.drawEllipse(placeOf(marks()[static_cast<std::size_t>(chosen_)]), ring, ring);
  }
  if (hasFocus()) {
    painter.setPen(QPen(palette().color(QPalette::Highlight), 2.0));
    painter.drawRect(rect().adjusted(1, 1, -1, -1));
  }
}

void PlotView::resizeEvent(QResizeEvent*) {
  drawing_.reset();
  painted_ = {};
}

void PlotView::changeEvent(QEvent* event) {
  QWidget::changeEvent(event);
  if (event->type() != QEvent::PaletteChange && event->type() != QEvent::FontChange) return;
  drawing_.reset();
  painted_ = {};
}

void PlotView::keyPressEvent(QKeyEvent* event) {
  const int last = static_cast<int>(marks().size()) - 1;
  const int key = event->key();
  if (last >= 0 && (key == Qt::Key_Right || key == Qt::Key_Down)) {
    choose(std::min(last, chosen_ + 1));
  } else if (last >= 0 && (key == Qt::Key_Left || key == Qt::Key_Up)) {
    choose(std::max(0, chosen_ - 1));
  } else if (chosen_ >= 0 && (key == Qt::Key_Return || key == Qt::Key_Enter)) {
    emit attemptChosen(QString::fromStdString(marks()[static_cast<std::size_t>(chosen_)].key));
  } else {
    QWidget::keyPressEvent(event);
  }
}

void PlotView::mousePressEvent(QMouseEvent* event) {
  if (event->button() != Qt::LeftButton) return;
  if (const analytics::DrawnMark* mark = markAt(event->position()))
    emit attemptChosen(QString::fromStdString(mark->key));
}

void PlotView::mouseMoveEvent(QMouseEvent* event) {
  const analytics::DrawnMark* const mark = markAt(event->position());
  if (mark != nullptr)
    QToolTip::showText(mapToGlobal(placeOf(*mark).toPoint()), QString::fromStdString(mark->text), this);
  else
    QToolTip::hideText();
}

}  // namespace calot::gui
