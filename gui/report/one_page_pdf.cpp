// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/report/one_page_pdf.h"

#include <algorithm>
#include <QAbstractTextDocumentLayout>
#include <QBuffer>
#include <QImage>
#include <QPainter>
#include <QPdfWriter>
#include <QTextBlock>

#include "gui/report/offscreen_application.h"
#include "gui/report/text_document.h"

namespace calot::gui {
namespace {

constexpr int onePageDots = 600;                                                                          // an inch
constexpr double onePageMargin = 15.0, betweenPictures = 4.0, captionHeight = 10.0, captionPoints = 7.5;  // mm; points
constexpr int columns = 3;

double dots(double millimetres) { return millimetres * onePageDots / 25.4; }

/// @return height that the pictures take (dots)
double paintPictures(QPainter& painter, const std::vector<CaptionedPicture>& pictures, const QSizeF& page, QFont font) {
  if (pictures.empty()) return 0.0;
  const double width = (page.width() - (columns - 1) * dots(betweenPictures)) / columns;
  const double height = 0.75 * width, top = page.height() - height - dots(captionHeight);
  font.setPointSizeF(captionPoints);
  painter.setFont(font);
  painter.setPen(Qt::black);
  painter.setRenderHint(QPainter::SmoothPixmapTransform);
  double left = 0.0;
  for (const CaptionedPicture& picture : pictures) {
    const Image& image = picture.image;
    const QImage shown(image.rgba.data(), image.width, image.height, 4 * image.width, QImage::Format_RGBA8888);
    const QSizeF fitted = QSizeF(shown.size()).scaled(QSizeF(width, height), Qt::KeepAspectRatio);
    painter.drawImage(QRectF(QPointF(left + (width - fitted.width()) / 2.0, top), fitted),
                      shown.convertToFormat(QImage::Format_RGB32));
    painter.drawText(QRectF(left, top + height + dots(1.0), width, dots(captionHeight - 1.0)),
                     Qt::AlignTop | Qt::AlignLeft | Qt::TextWordWrap, QString::fromStdString(picture.caption));
    left += width + dots(betweenPictures);
  }
  return height + dots(captionHeight + betweenPictures);
}

}  // namespace

std::string onePagePdf(const analytics::ReportDocument& document, const std::vector<CaptionedPicture>& pictures,
                       const std::string& maker) {
  const OffscreenApplication application;
  const QFont font = reportFont();
  QBuffer bytes;
  bytes.open(QIODevice::WriteOnly);
  {
    QPdfWriter writer(&bytes);
    writer.setResolution(onePageDots);
    writer.setPageSize(QPageSize(QPageSize::A4));
    writer.setPageMargins(QMarginsF(onePageMargin, onePageMargin, onePageMargin, onePageMargin),
                          QPageLayout::Millimeter);
    writer.setTitle(QString(document.synthetic ? "SYNTHETIC: " : "") + QString::fromStdString(document.title));
    writer.setCreator(QString::fromStdString(maker));
    const QSizeF page(writer.width(), writer.height());
    QPainter painter(&writer);
    const double room = page.height() - paintPictures(painter, pictures, page, font);
    // Laid out on one long page, which is then made as small as it has to be.
    constexpr double longPage = 20.0;
    ReportTextDocument text(document, &writer, QSizeF(page.width(), longPage * page.height()));
    const double height = text.documentLayout()->documentSize().height();
    double used = 0.0;
    for (QTextBlock block = text.begin(); block.isValid(); block = block.next())
      used = std::max(used, text.documentLayout()->blockBoundingRect(block).bottom());
    used = used > 0.0 ? std::min(used, height) : height;
    const double scale = std::min(1.0, room / used);
    painter.scale(scale, scale);
    QAbstractTextDocumentLayout::PaintContext context;
    context.palette.setColor(QPalette::Text, Qt::black);
    context.clip = QRectF(0.0, 0.0, page.width(), used);
    text.documentLayout()->draw(&painter, context);
  }
  return bytes.data().toStdString();
}

}  // namespace calot::gui
