// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/report/drawing_painter.h"

#include <algorithm>
#include <QFontDatabase>
#include <QFontMetricsF>
#include <QPen>
#include <QString>

#include "recorder/base/errors.h"

namespace calot::gui {
namespace {

using analytics::Anchor;
using analytics::InkStyle;

// Fonts are laid out at this many units a unit of the drawing: metrics of letters of ten pixels would be rounded.
constexpr double fine = 32.0;

struct ShapePainter {
  QPainter& painter;
  const InkStyle& style;
  const QFont& letters;

  void operator()(const analytics::DrawnLine& l) const { painter.drawLine(QPointF(l.x1, l.y1), QPointF(l.x2, l.y2)); }
  void operator()(const analytics::DrawnBox& b) const { painter.drawRect(QRectF(b.x, b.y, b.width, b.height)); }
  void operator()(const analytics::DrawnPoint& p) const { painter.drawEllipse(QPointF(p.x, p.y), p.radius, p.radius); }
  void operator()(const analytics::DrawnText& t) const {
    QFont font = letters;
    font.setPixelSize(static_cast<int>(style.letters * fine));
    font.setBold(style.bold);
    const QString text = QString::fromStdString(t.text);
    const double length = QFontMetricsF(font).horizontalAdvance(text);
    painter.save();
    painter.translate(t.x, t.y);
    painter.rotate(t.degrees);
    painter.scale(1.0 / fine, 1.0 / fine);
    painter.setFont(font);
    painter.setPen(painter.brush().color());
    painter.drawText(QPointF(style.anchor == Anchor::start    ? 0.0
                             : style.anchor == Anchor::middle ? -length / 2.0
                                                              : -length,
                             0.0),
                     text);
    painter.restore();
  }
};

QColor colourOf(const char* name, const DrawingLook& look) {
  const QColor colour(name);
  return look.colour == nullptr ? colour : look.colour(colour);
}

QPen penOf(const InkStyle& style, const DrawingLook& look) {
  if (*style.stroke == '\0') return QPen(Qt::NoPen);
  QPen pen(colourOf(style.stroke, look), style.strokeWidth);
  pen.setCapStyle(Qt::FlatCap);
  // In widths of the line.
  if (style.dashed) pen.setDashPattern({analytics::dashOn / style.strokeWidth, analytics::dashOff / style.strokeWidth});
  return pen;
}

QBrush brushOf(const InkStyle& style, const DrawingLook& look) {
  if (*style.fill == '\0') return QBrush(Qt::NoBrush);
  QColor colour = colourOf(style.fill, look);
  colour.setAlphaF(static_cast<float>(style.fillOpacity));
  return QBrush(colour);
}

}  // namespace

void paintDrawing(QPainter& painter, const analytics::Drawing& drawing, const QRectF& target, const DrawingLook& look) {
  const double scale = std::min(target.width() / drawing.width, target.height() / drawing.height);
  painter.save();
  painter.translate(target.topLeft());
  painter.scale(scale, scale);
  for (const analytics::Shape& shape : drawing.shapes) {
    const InkStyle& style = analytics::styleOf(shape.ink);
    painter.setPen(penOf(style, look));
    painter.setBrush(brushOf(style, look));
    std::visit(ShapePainter{painter, style, look.font}, shape.form);
  }
  painter.restore();
}

QFont reportFont() {
  if (QFontDatabase::families().isEmpty())
    throw Error(ErrorKind::failure, "no font is installed, and a PDF needs one (Debian: fonts-dejavu-core)");
  QFont font;
  font.setFamilies({"DejaVu Sans", "Liberation Sans", "Sans Serif"});
  return font;
}

}  // namespace calot::gui
