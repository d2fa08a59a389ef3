// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <QObject>
#include <QPagedPaintDevice>
#include <QTextBlock>
#include <QTextDocument>
#include <QTextObjectInterface>
#include <variant>
#include <vector>

#include "analytics/report/report_document.h"

class QTextTable;

namespace calot::gui {

/// The part of a device's page that text may fill, in its dots: the rest is the foot.
QSizeF textPageOf(const QPagedPaintDevice& device);

/// A report as Qt lays it out: headings, paragraphs with links, lists, tables whose heads are repeated, figures,
/// pictures, boxes to write in. A heading is on the page of what follows it: of a table that fits into half a page with
/// all of it, of a longer one with its head and first rows. No row is divided between pages. Sizes are those of the
/// device that it is laid out for.
class ReportTextDocument : public QTextDocument, public QTextObjectInterface {
  Q_OBJECT
  Q_INTERFACES(QTextObjectInterface)

 public:
  /// @param report must outlive this
  /// @param device its dots count; must outlive this
  /// @param page what text may fill of one page, in the device's dots
  ReportTextDocument(const analytics::ReportDocument& report, QPagedPaintDevice* device, const QSizeF& page);

  /// Top and bottom of a block's first lines, or of all, in the device's dots from the document's beginning.
  struct Extent {
    double top = 0.0, bottom = 0.0;
  };
  [[nodiscard]] Extent extentOf(const QTextBlock& block, int lines = std::numeric_limits<int>::max()) const;
  [[nodiscard]] Extent extentOf(const QTextTable& table, int row) const;  ///< of the text of its cells
  /// Page of a place, from 0.
  [[nodiscard]] int pageOf(double place) const;
  [[nodiscard]] static bool isHeading(const QTextBlock& block);

  QSizeF intrinsicSize(QTextDocument* document, int position, const QTextFormat& format) override;
  void drawObject(QPainter* painter, const QRectF& rect, QTextDocument* document, int position,
                  const QTextFormat& format) override;

 private:
  struct Writer;
  void keepTogether();

  QPagedPaintDevice* device_;
  QSizeF page_;
  using Object = std::variant<const analytics::Drawing*, const analytics::Picture*, const analytics::Blank*>;
  std::vector<Object> objects_;  ///< what is drawn between the words
};

}  // namespace calot::gui
