// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QPainter>
#include <QRectF>

#include "analytics/report/drawing.h"

namespace calot::gui {

/// Paints a figure into `target`, as large as fits in it. Letters are of the application's font.
void paintDrawing(QPainter& painter, const analytics::Drawing& drawing, const QRectF& target);

}  // namespace calot::gui
