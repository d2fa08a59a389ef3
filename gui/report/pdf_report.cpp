// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/report/pdf_report.h"

#include <clocale>
#include <QAbstractTextDocumentLayout>
#include <QBuffer>
#include <QFont>
#include <QGuiApplication>
#include <QPageRanges>
#include <QPainter>
#include <QPainterPath>
#include <QPdfWriter>
#include <utility>

#include "gui/report/drawing_painter.h"
#include "gui/report/text_document.h"

namespace calot::gui {
namespace {

constexpr int dotsPerInch = 600;
constexpr double marginMillimetres = 15.0, footPoints = 7.0, markPoints = 90.0;

void paintMark(QPainter& painter, const QSizeF& page, QFont font) {
  painter.save();
  font.setPointSizeF(markPoints);
  font.setBold(true);
  painter.setFont(font);
  painter.setPen(QColor("#fbeef0"));  // behind the text: opaque, as paper shows it
  painter.translate(page.width() / 2.0, page.height() / 2.0);
  painter.rotate(-52.0);
  const double reach = page.height();
  painter.drawText(QRectF(-reach, -reach / 4.0, 2.0 * reach, reach / 2.0), Qt::AlignCenter, "SYNTHETIC");
  painter.restore();
}

void paintFoot(QPainter& painter, const QRectF& foot, QFont font, const QString& title, int page, int pages) {
  painter.save();
  font.setPointSizeF(footPoints);
  painter.setFont(font);
  painter.setPen(QColor("#57606a"));
  const QString number = QString("page %1 of %2").arg(page).arg(pages);
  const QFontMetricsF metrics(font, painter.device());
  const double room = foot.width() - 1.5 * metrics.horizontalAdvance(number);
  painter.drawText(foot, Qt::AlignLeft | Qt::AlignBottom, metrics.elidedText(title, Qt::ElideRight, room));
  painter.drawText(foot, Qt::AlignRight | Qt::AlignBottom, number);
  painter.restore();
}

QString titleOf(const analytics::ReportDocument& document) {
  return QString(document.synthetic ? "SYNTHETIC: " : "") + QString::fromStdString(document.title);
}

/// Qt's application without a display, where none is there yet; else null. Qt takes the user's locale as the process':
/// numbers would get his decimal comma from then on. And it warns of what a desktop would have.
std::unique_ptr<QGuiApplication> offscreenApplication() {
  if (QCoreApplication::instance() != nullptr) return nullptr;
  static char name[] = "calot", option[] = "-platform", platform[] = "offscreen";
  static char* words[] = {name, option, platform, nullptr};
  static int count = 3;
  const std::string locale = std::setlocale(LC_ALL, nullptr);
  const QtMessageHandler before = qInstallMessageHandler([](QtMsgType, const QMessageLogContext&, const QString&) {});
  auto application = std::make_unique<QGuiApplication>(count, words);
  qInstallMessageHandler(before);
  std::setlocale(LC_ALL, locale.c_str());
  return application;
}

/// Bytes of a PDF that `paint` fills: A4, of `dots` an inch, all margins alike (mm).
std::string pdfOf(const QString& title, const std::string& maker, int dots, double margin,
                  const std::function<void(QPdfWriter& writer, const QFont& font)>& paint) {
  const std::unique_ptr<QGuiApplication> application = offscreenApplication();
  const QFont font = reportFont();
  QBuffer bytes;
  bytes.open(QIODevice::WriteOnly);
  {
    QPdfWriter writer(&bytes);
    writer.setResolution(dots);
    writer.setPageSize(QPageSize(QPageSize::A4));
    writer.setPageMargins(QMarginsF(margin, margin, margin, margin), QPageLayout::Millimeter);
    writer.setTitle(title);
    writer.setCreator(QString::fromStdString(maker));
    paint(writer, font);
  }
  return bytes.data().toStdString();
}

}  // namespace

void paintReport(const analytics::ReportDocument& document, QPagedPaintDevice& device) {
  const QString title = titleOf(document);
  const QFont font = reportFont();
  const QSizeF whole(device.width(), device.height()), page = textPageOf(device);
  ReportTextDocument text(document, &device, page);
  const int pages = text.pageCount();
  QPainter painter(&device);
  const QPageRanges wanted = device.pageRanges();
  bool begun = false;
  for (int i = 0; i < pages; ++i) {
    if (!wanted.isEmpty() && !wanted.contains(i + 1)) continue;
    if (std::exchange(begun, true)) device.newPage();
    if (document.synthetic) paintMark(painter, whole, font);
    const QRectF seen(0.0, i * page.height(), page.width(), page.height());
    painter.save();
    painter.translate(0.0, -seen.top());
    painter.setClipRect(seen);
    QAbstractTextDocumentLayout::PaintContext context;
    context.clip = seen;
    context.palette.setColor(QPalette::Text, Qt::black);
    text.documentLayout()->draw(&painter, context);
    painter.restore();
    paintFoot(painter, QRectF(0.0, page.height(), whole.width(), whole.height() - page.height()), font, title, i + 1,
              pages);
  }
}

std::string pdfReport(const analytics::ReportDocument& document, const std::string& maker) {
  return pdfOf(titleOf(document), maker, dotsPerInch, marginMillimetres,
               [&](QPdfWriter& writer, const QFont&) { paintReport(document, writer); });
}

namespace {

constexpr int sheetDotsPerInch = 1200;
constexpr double dotsPerMillimetre = sheetDotsPerInch / 25.4;

/// The black part of a tag as one shape: shapes that touch show seams on screens.
QPainterPath shapeOf(const recorder::SheetTag& tag, const std::array<bool, 100>& cells) {
  const double cell = tag.side / 8.0;
  QPainterPath out;
  std::size_t cellIndex = 0;
  for (int row = 0; row < 10; ++row) {
    for (int column = 0; column < 10; ++column) {
      if (!cells[cellIndex++]) continue;
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
  return pdfOf("Calot: handles and board", maker, sheetDotsPerInch, 0.0, [&](QPdfWriter& writer, const QFont& font) {
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
  });
}

}  // namespace calot::gui
