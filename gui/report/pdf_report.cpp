// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/report/pdf_report.h"

#include <QAbstractTextDocumentLayout>
#include <QBuffer>
#include <QFont>
#include <QPainter>
#include <QPdfWriter>

#include "gui/report/offscreen_application.h"
#include "gui/report/text_document.h"

namespace calot::gui {
namespace {

constexpr int dotsPerInch = 600;
constexpr double marginMillimetres = 15.0, footMillimetres = 8.0, footPoints = 7.0, markPoints = 90.0;

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

}  // namespace

std::string pdfReport(const analytics::ReportDocument& document, const std::string& maker) {
  const OffscreenApplication application;
  const QFont font = reportFont();
  QBuffer bytes;
  bytes.open(QIODevice::WriteOnly);
  {
    const QString title = QString(document.synthetic ? "SYNTHETIC: " : "") + QString::fromStdString(document.title);
    QPdfWriter writer(&bytes);
    writer.setResolution(dotsPerInch);
    writer.setPageSize(QPageSize(QPageSize::A4));
    writer.setPageMargins(QMarginsF(marginMillimetres, marginMillimetres, marginMillimetres, marginMillimetres),
                          QPageLayout::Millimeter);
    writer.setTitle(title);
    writer.setCreator(QString::fromStdString(maker));
    const double footHeight = footMillimetres * dotsPerInch / 25.4;
    const QSizeF whole(writer.width(), writer.height()), page(whole.width(), whole.height() - footHeight);
    ReportTextDocument text(document, &writer, page);
    const int pages = text.pageCount();
    QPainter painter(&writer);
    for (int i = 0; i < pages; ++i) {
      if (i > 0) writer.newPage();
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
      paintFoot(painter, QRectF(0.0, page.height(), whole.width(), footHeight), font, title, i + 1, pages);
    }
  }
  return bytes.data().toStdString();
}

}  // namespace calot::gui
