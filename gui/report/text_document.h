// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>
#include <QPagedPaintDevice>
#include <QTextDocument>
#include <QTextObjectInterface>
#include <variant>
#include <vector>

#include "analytics/report/report_document.h"

namespace calot::gui {

/// A report as Qt lays it out: headings, paragraphs with links, lists, tables whose heads are repeated, figures,
/// pictures, boxes to write in. Sizes
/// are those of the device that it is laid out for.
class ReportTextDocument : public QTextDocument, public QTextObjectInterface {
  Q_OBJECT
  Q_INTERFACES(QTextObjectInterface)

 public:
  /// @param report must outlive this
  /// @param device its dots count; must outlive this
  /// @param page what text may fill of one page, in the device's dots
  ReportTextDocument(const analytics::ReportDocument& report, QPagedPaintDevice* device, const QSizeF& page);

  QSizeF intrinsicSize(QTextDocument* document, int position, const QTextFormat& format) override;
  void drawObject(QPainter* painter, const QRectF& rect, QTextDocument* document, int position,
                  const QTextFormat& format) override;

 private:
  struct Writer;

  QPagedPaintDevice* device_;
  QSizeF page_;
  using Object = std::variant<const analytics::Drawing*, const analytics::Picture*, const analytics::Blank*>;
  std::vector<Object> objects_;  ///< what is drawn between the words
};

}  // namespace calot::gui
