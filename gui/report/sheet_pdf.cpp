// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/report/sheet_pdf.h"

#include <QBuffer>
#include <QPainter>
#include <QPainterPath>
#include <QPdfWriter>

#include "gui/report/offscreen_application.h"

namespace calot::gui {
namespace {

constexpr int sheetDotsPerInch = 1200;
constexpr double dotsPerMillimetre = sheetDotsPerInch / 25.4;

/// The black part of a tag as one shape: shapes that touch show seams on screens.
QPainterPath shapeOf(const recorder::SheetTag& tag, const std::array<bool, 100>& cells) {
  const double cell = tag.side / 8.0;
  QPainterPath out;
  for (int row = 0; row < 10; ++row) {
    for (int column = 0; column < 10; ++column) {
      if (!cells[static_cast<std::size_t>(10 * row + column)]) continue;
      out.addRect(QRectF(tag.left + (column - 1) * cell, tag.top + (row - 1) * cell, cell, cell));
    }
  }
  return out.simplified();
}

QPen penOf(recorder::SheetLine::Kind kind) {
  QPen pen(kind == recorder::SheetLine::Kind::ruler ? Qt::black : QColor("#57606a"));
  pen.setWidthF(0.2);
  pen.setCapStyle(Qt::FlatCap);
  if (kind == recorder::SheetLine::Kind::fold) pen.setDashPattern({8.0, 6.0});
  return pen;
}

void paintSheet(QPainter& painter, const recorder::MarkerSheet& sheet,
                const std::function<std::array<bool, 100>(int id)>& cells, QFont font) {
  for (const recorder::SheetTag& tag : sheet.tags) painter.fillPath(shapeOf(tag, cells(tag.id)), Qt::black);
  for (const recorder::SheetLine& line : sheet.lines) {
    painter.setPen(penOf(line.kind));
    painter.drawLine(QPointF(line.x1, line.y1), QPointF(line.x2, line.y2));
  }
  painter.setPen(Qt::black);
  for (const recorder::SheetText& text : sheet.texts) {
    // Letters are drawn in dots: fonts of a few units would be rounded.
    painter.save();
    painter.translate(text.x, text.y);
    painter.scale(1.0 / dotsPerMillimetre, 1.0 / dotsPerMillimetre);
    font.setPixelSize(static_cast<int>(text.size * dotsPerMillimetre));
    painter.setFont(font);
    painter.drawText(QPointF(0.0, 0.0), QString::fromStdString(text.text));
    painter.restore();
  }
}

}  // namespace

std::string sheetsPdf(const std::vector<recorder::MarkerSheet>& sheets, const std::string& maker,
                      const std::function<std::array<bool, 100>(int id)>& cells) {
  const OffscreenApplication application;
  const QFont font = reportFont();
  QBuffer bytes;
  bytes.open(QIODevice::WriteOnly);
  {
    QPdfWriter writer(&bytes);
    writer.setResolution(sheetDotsPerInch);
    writer.setTitle("Calot: handles and board");
    writer.setCreator(QString::fromStdString(maker));
    const auto layOut = [&](const recorder::MarkerSheet& sheet) {
      const auto way = sheet.width > sheet.height ? QPageLayout::Landscape : QPageLayout::Portrait;
      writer.setPageLayout(QPageLayout(QPageSize(QPageSize::A4), way, QMarginsF(), QPageLayout::Millimeter));
    };
    layOut(sheets.front());
    QPainter painter(&writer);
    for (std::size_t i = 0; i < sheets.size(); ++i) {
      if (i > 0) {
        layOut(sheets[i]);
        writer.newPage();
      }
      painter.save();
      painter.scale(dotsPerMillimetre, dotsPerMillimetre);
      paintSheet(painter, sheets[i], cells, font);
      painter.restore();
    }
  }
  return bytes.data().toStdString();
}

}  // namespace calot::gui
