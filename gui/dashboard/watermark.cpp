// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/watermark.h"

#include <algorithm>
#include <QFont>
#include <QGraphicsScene>
#include <QGraphicsSimpleTextItem>
#include <QSize>
#include <QTransform>

#include "gui/attempt/theme.h"

namespace calot::gui {
namespace {

constexpr double slant = -22.0;  // degrees
constexpr double share = 0.9;    // of the chart, at most

}  // namespace

Watermark::Watermark(QGraphicsScene& scene) : item_(new QGraphicsSimpleTextItem("SYNTHETIC")) {
  QFont font;
  font.setBold(true);
  font.setPixelSize(84);
  item_->setFont(font);
  item_->setRotation(slant);
  item_->setZValue(100.0);
  item_->setVisible(false);
  scene.addItem(item_);
}

void Watermark::setVisible(bool visible) {
  QColor ink = theme::text();
  ink.setAlpha(34);
  item_->setBrush(ink);
  item_->setVisible(visible);
}
bool Watermark::isVisible() const { return item_->isVisible(); }

void Watermark::place(const QSize& chart) {
  const QRectF box = item_->boundingRect();
  const QRectF aslant = QTransform().rotate(slant).mapRect(box);
  item_->setTransformOriginPoint(box.center());
  item_->setScale(std::min({1.0, share * chart.width() / aslant.width(), share * chart.height() / aslant.height()}));
  item_->setPos(QPointF(chart.width() / 2.0, chart.height() / 2.0) - box.center());
}

}  // namespace calot::gui
