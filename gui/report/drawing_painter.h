// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <QColor>
#include <QFont>
#include <QGuiApplication>
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

/// Qt's application without a display, where none is there yet. Qt takes the user's locale as the process': numbers
/// would get his decimal comma from then on. And it warns of what a desktop would have.
class OffscreenApplication {
 public:
  OffscreenApplication();

 private:
  char name_[6] = "calot", option_[10] = "-platform", platform_[10] = "offscreen";
  char* words_[4] = {name_, option_, platform_, nullptr};
  int count_ = 3;
  std::unique_ptr<QGuiApplication> application_;
};

/// The font of what is printed. @throws Error (failure) where no font is installed
QFont reportFont();

}  // namespace calot::gui
