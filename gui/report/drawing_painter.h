// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QColor>
#include <QFont>
#include <QPainter>
#include <QRectF>

#include "analytics/report/drawing.h"

namespace calot::gui {

/// Letters and colours of a drawing. On paper colours are the drawing's own.
struct DrawingLook {
  QFont font;
  QColor (*colour)(const QColor&) = nullptr;  ///< what is painted instead of a colour, or null
};

/// Paints a figure into `target`, as large as fits in it.
void paintDrawing(QPainter& painter, const analytics::Drawing& drawing, const QRectF& target, const DrawingLook& look);

/// The font of what is printed. @throws Error (failure) where no font is installed
QFont reportFont();

}  // namespace calot::gui
