// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/report/text_document.h"

#include <algorithm>
#include <cmath>
#include <QAbstractTextDocumentLayout>
#include <QFontMetricsF>
#include <QImage>
#include <QPainter>
#include <QTextBlock>
#include <QTextCursor>
#include <QTextFrame>
#include <QTextList>
#include <QTextTable>

#include "gui/report/drawing_painter.h"

namespace calot::gui {
namespace {

using analytics::Paragraph;

constexpr int drawnObject = QTextFormat::UserObject + 1, objectNumber = QTextFormat::UserProperty + 1,
              keptWithNext = QTextFormat::UserProperty + 2;
constexpr double textPoints = 8.5, tablePoints = 7.5, headingPoints = 11.0, titlePoints = 15.0;
constexpr double figureMillimetres = 84.0;  // of a figure as wide as a box plot: two stand side by side
constexpr double usualWidth = 320.0;        // in the drawing's units
constexpr double picturesInLine = 3.0, captionHeight = 10.0, pictureGap = 2.0;  // mm
// In millimetres: between text and border; what a line needs beyond its letters; the narrowest column of words.
constexpr double cellPadding = 0.6, aroundText = 1.0, minWidth = 12.0;

/// Margins, borders and columns are given for a screen of 96 dots an inch, from which Qt turns them into the device's.
double length(double millimetres) { return millimetres * 96.0 / 25.4; }

QTextCharFormat letters(double points, bool bold = false) {
  QTextCharFormat format;
  format.setFontPointSize(points);
  if (bold) format.setFontWeight(QFont::Bold);
  return format;
}

}  // namespace

struct ReportTextDocument::Writer {
  ReportTextDocument& document;
  QTextCursor cursor{&document};

  QTextBlockFormat block(double above, double below) const {
    QTextBlockFormat format;
    format.setTopMargin(length(above));
    format.setBottomMargin(length(below));
    return format;
  }

  /// The first block is there already, as is the one behind a table.
  void begin(const QTextBlockFormat& format, const QTextCharFormat& ink) {
    if (cursor.block().length() == 1) {
      cursor.setBlockFormat(format);
      cursor.setBlockCharFormat(ink);
    } else {
      cursor.insertBlock(format, ink);
    }
  }

  /// A block of one text.
  void line(const std::string& text, const QTextBlockFormat& format, const QTextCharFormat& ink) {
    begin(format, ink);
    cursor.insertText(QString::fromStdString(text), ink);
  }

  void spans(const Paragraph& paragraph, const QTextCharFormat& ink) {
    for (const analytics::TextSpan& span : paragraph) {
      QTextCharFormat format = ink;
      if (!span.link.empty()) {
        format.setAnchor(true);
        format.setAnchorHref(QString::fromStdString(span.link));
        format.setForeground(QColor("#0b5a8a"));
      }
      cursor.insertText(QString::fromStdString(span.text), format);
    }
  }

  void banner() {
    QTextBlockFormat format = block(1.0, 3.0);
    format.setBackground(QColor("#b00020"));
    QTextCharFormat ink = letters(textPoints, true);
    ink.setForeground(Qt::white);
    line(std::string(" ") + analytics::watermarkText, format, ink);
  }

  void operator()(const analytics::Heading& heading) {
    QTextBlockFormat format = block(5.0, 1.5);
    format.setProperty(keptWithNext, true);
    if (heading.newPage) format.setPageBreakPolicy(QTextFormat::PageBreak_AlwaysBefore);
    line(heading.text, format, letters(headingPoints, true));
  }

  void operator()(const Paragraph& paragraph) {
    begin(block(0.5, 1.5), letters(textPoints));
    spans(paragraph, letters(textPoints));
  }

  void operator()(const analytics::BulletList& list) {
    QTextList* bullets = nullptr;
    for (const Paragraph& item : list.items) {
      begin(block(0.0, 0.7), letters(textPoints));
      if (bullets == nullptr) {
        QTextListFormat format;
        format.setStyle(QTextListFormat::ListDisc);
        format.setIndent(1);
        bullets = cursor.createList(format);
      } else {
        bullets->add(cursor.block());
      }
      spans(item, letters(textPoints));
    }
  }

  void operator()(const analytics::ReportTable& table) {
    (*this)(analytics::Heading{table.title});
    const int columns = static_cast<int>(table.columns.size());
    QTextTableFormat format;
    format.setHeaderRowCount(1);
    format.setBorder(length(0.3));
    format.setBorderBrush(QColor("#d8dde3"));
    format.setBorderStyle(QTextFrameFormat::BorderStyle_Solid);
    format.setBorderCollapse(true);
    format.setCellPadding(length(cellPadding));
    format.setCellSpacing(0.0);
    format.setBottomMargin(length(4.0));
    format.setColumnWidthConstraints(columnsOf(table));
    QTextTable* grid = cursor.insertTable(static_cast<int>(table.rows.size()) + 1, columns, format);
    for (int c = 0; c < columns; ++c) {
      const auto& [name, align] = table.columns[static_cast<std::size_t>(c)];
      cell(*grid, 0, c, name, align, true);
      for (int r = 0; r < static_cast<int>(table.rows.size()); ++r)
        cell(*grid, r + 1, c, table.rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)], align, false);
    }
    cursor.movePosition(QTextCursor::End);
  }

  /// As wide as their texts; where that is more than the page, the widest columns of words are cut down to one width.
  QVector<QTextLength> columnsOf(const analytics::ReportTable& table) const {
    QFont font = document.defaultFont();
    font.setPointSizeF(tablePoints);
    font.setBold(true);
    const QFontMetricsF metrics(font, document.device_);
    const double dotsPerMillimetre = document.device_->logicalDpiX() / 25.4;
    const auto isWords = [&](std::size_t c) { return table.columns[c].second == analytics::Align::left; };
    std::vector<double> width, words;
    double room = document.page_.width() / dotsPerMillimetre - 1.0;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      double widest = metrics.horizontalAdvance(QString::fromStdString(table.columns[c].first));
      for (const auto& row : table.rows)
        widest = std::max(widest, metrics.horizontalAdvance(QString::fromStdString(row[c])));
      width.push_back(widest / dotsPerMillimetre + 2.0 * cellPadding + aroundText);
      if (isWords(c))
        words.push_back(width.back());
      else
        room -= width.back();
    }
    std::sort(words.begin(), words.end());
    double maxWords = words.empty() ? 0.0 : words.back();
    for (std::size_t i = 0; i < words.size(); ++i) {
      const double each = std::max(minWidth, room / static_cast<double>(words.size() - i));
      if (words[i] > each) {
        maxWords = each;
        break;
      }
      room -= words[i];
    }
    QVector<QTextLength> lengths;
    for (std::size_t c = 0; c < width.size(); ++c)
      lengths.push_back(
          QTextLength(QTextLength::FixedLength, length(isWords(c) ? std::min(width[c], maxWords) : width[c])));
    return lengths;
  }

  static void cell(QTextTable& grid, int row, int column, const std::string& text, analytics::Align align, bool bold) {
    QTextCursor inside = grid.cellAt(row, column).firstCursorPosition();
    QTextBlockFormat format;
    format.setAlignment(align == analytics::Align::right ? Qt::AlignRight : Qt::AlignLeft);
    inside.setBlockFormat(format);
    inside.setBlockCharFormat(letters(tablePoints, bold));  // an empty cell is no higher
    inside.insertText(QString::fromStdString(text), letters(tablePoints, bold));
  }

  /// Something drawn, in the line of the cursor.
  template <class Drawn>
  void object(const Drawn& drawn) {
    QTextCharFormat format;
    format.setObjectType(drawnObject);
    format.setProperty(objectNumber, static_cast<int>(document.objects_.size()));
    document.objects_.emplace_back(&drawn);
    cursor.insertText(QString(QChar::ObjectReplacementCharacter), format);
  }

  void operator()(const analytics::Figures& figures) {
    begin(block(1.0, 1.0), letters(textPoints));
    for (const analytics::Drawing& drawing : figures.drawings) {
      object(drawing);
      cursor.insertText(" ", letters(textPoints));
    }
  }

  void operator()(const analytics::Pictures& pictures) {
    begin(block(1.0, 1.0), letters(textPoints));
    for (const analytics::Picture& picture : pictures.pictures) object(picture);
  }

  void operator()(const analytics::Blank& blank) {
    begin(block(2.5, 1.0), letters(textPoints));
    object(blank);
  }
};

QSizeF textPageOf(const QPagedPaintDevice& device) {
  constexpr double footMillimetres = 8.0;
  // Whole dots: Qt lays out in parts of a dot, and pages would drift apart from what is painted.
  return QSizeF(device.width(), std::floor(device.height() - footMillimetres * device.logicalDpiX() / 25.4));
}

ReportTextDocument::ReportTextDocument(const analytics::ReportDocument& report, QPagedPaintDevice* device,
                                       const QSizeF& page)
    : device_(device), page_(page) {
  setUndoRedoEnabled(false);
  setDefaultFont(reportFont());
  setDocumentMargin(0.0);
  documentLayout()->setPaintDevice(device);
  documentLayout()->registerHandler(drawnObject, this);
  Writer writer{*this};
  writer.cursor.beginEditBlock();
  if (report.synthetic) writer.banner();
  writer.line(report.title, writer.block(0.0, 3.0), letters(titlePoints, true));
  for (const auto& part : report.parts) std::visit(writer, part);
  if (report.synthetic) writer.banner();
  writer.cursor.endEditBlock();
  setPageSize(page);
  keepTogether();
}

ReportTextDocument::Extent ReportTextDocument::extentOf(const QTextBlock& block, int lines) const {
  const double top = documentLayout()->blockBoundingRect(block).top();
  const QTextLayout& layout = *block.layout();
  if (layout.lineCount() == 0) return {top, top};
  const QTextLine first = layout.lineAt(0), last = layout.lineAt(std::min(lines, layout.lineCount()) - 1);
  return {top + first.y(), top + last.y() + last.height()};
}

int ReportTextDocument::pageOf(double place) const { return static_cast<int>(std::floor(place / page_.height())); }

bool ReportTextDocument::isHeading(const QTextBlock& block) { return block.blockFormat().boolProperty(keptWithNext); }

ReportTextDocument::Extent ReportTextDocument::extentOf(const QTextTable& table, int row) const {
  Extent all{std::numeric_limits<double>::max(), 0.0};
  for (int column = 0; column < table.columns(); ++column) {
    const Extent cell = extentOf(table.cellAt(row, column).firstCursorPosition().block());
    all = {std::min(all.top, cell.top), std::max(all.bottom, cell.bottom)};
  }
  return all;
}

/// Qt divides a document into pages line by line and knows nothing of what belongs together.
void ReportTextDocument::keepTogether() {
  constexpr int firstRows = 3, firstLines = 2;
  constexpr double undividedTable = 0.5;  // of a page
  const auto startPage = [this](const QTextBlock& block) {
    QTextCursor cursor(block);
    QTextBlockFormat format = block.blockFormat();
    format.setPageBreakPolicy(QTextFormat::PageBreak_AlwaysBefore);
    cursor.setBlockFormat(format);
  };
  for (QTextBlock block = begin(); block.isValid(); block = block.next()) {
    if (!isHeading(block)) continue;
    const QTextBlock next = block.next();
    if (!next.isValid()) break;
    const double top = extentOf(block).top;
    double bottom = extentOf(next, firstLines).bottom;
    const QTextTable* const table = QTextCursor(next).currentTable();
    if (table != nullptr) {
      const double whole = extentOf(*table, table->rows() - 1).bottom;
      const bool divided = whole - top > undividedTable * page_.height();
      bottom = divided ? extentOf(*table, std::min(firstRows, table->rows() - 1)).bottom : whole;
    }
    if (pageOf(top) != pageOf(bottom - 1.0)) startPage(block);
    if (table == nullptr) continue;
    for (int row = 1; row < table->rows(); ++row) {
      if (const Extent lines = extentOf(*table, row); pageOf(lines.top) == pageOf(lines.bottom - 1.0)) continue;
      for (int column = 0; column < table->columns(); ++column)
        startPage(table->cellAt(row, column).firstCursorPosition().block());
    }
  }
}

QSizeF ReportTextDocument::intrinsicSize(QTextDocument*, int, const QTextFormat& format) {
  const double dotsPerMillimetre = device_->logicalDpiX() / 25.4;
  const auto& object = objects_.at(static_cast<std::size_t>(format.intProperty(objectNumber)));
  if (const auto* blank = std::get_if<const analytics::Blank*>(&object))
    return {page_.width(), (*blank)->millimetres * dotsPerMillimetre};
  if (std::holds_alternative<const analytics::Picture*>(object)) {
    const double width = std::floor(page_.width() / picturesInLine);
    return {width, 0.75 * (width - pictureGap * dotsPerMillimetre) + captionHeight * dotsPerMillimetre};
  }
  const analytics::Drawing& drawing = *std::get<const analytics::Drawing*>(object);
  const double width = std::min(figureMillimetres * dotsPerMillimetre * drawing.width / usualWidth, page_.width());
  return {width, width * drawing.height / drawing.width};
}

void ReportTextDocument::drawObject(QPainter* painter, const QRectF& rect, QTextDocument*, int,
                                    const QTextFormat& format) {
  const double dotsPerMillimetre = device_->logicalDpiX() / 25.4;
  const auto& object = objects_.at(static_cast<std::size_t>(format.intProperty(objectNumber)));
  if (const auto* drawing = std::get_if<const analytics::Drawing*>(&object)) {
    paintDrawing(*painter, **drawing, rect, {reportFont()});
    return;
  }
  painter->save();
  QFont font = reportFont();
  font.setPointSizeF(tablePoints);
  painter->setFont(font);
  if (const auto* blank = std::get_if<const analytics::Blank*>(&object)) {
    const double inside = dotsPerMillimetre;
    painter->setPen(QPen(QColor("#57606a"), 0.2 * dotsPerMillimetre));
    painter->drawRect(rect.adjusted(0.0, 0.0, -inside, -inside));
    painter->drawText(rect.adjusted(inside, inside, -inside, -inside), Qt::AlignTop | Qt::AlignLeft,
                      QString::fromStdString((*blank)->label));
  } else {
    const analytics::Picture& picture = *std::get<const analytics::Picture*>(object);
    const QImage image = QImage::fromData(reinterpret_cast<const uchar*>(picture.png.data()),
                                          static_cast<int>(picture.png.size()), "PNG")
                             .convertToFormat(QImage::Format_RGB32);
    const QRectF space = rect.adjusted(0.0, 0.0, -pictureGap * dotsPerMillimetre, -captionHeight * dotsPerMillimetre);
    const QSizeF fitted = QSizeF(image.size()).scaled(space.size(), Qt::KeepAspectRatio);
    painter->setRenderHint(QPainter::SmoothPixmapTransform);
    painter->drawImage(QRectF(space.topLeft(), fitted), image);
    painter->setPen(Qt::black);
    painter->drawText(QRectF(space.left(), space.bottom() + dotsPerMillimetre, space.width(),
                             (captionHeight - 1.0) * dotsPerMillimetre),
                      Qt::AlignTop | Qt::AlignLeft | Qt::TextWordWrap, QString::fromStdString(picture.caption));
  }
  painter->restore();
}

}  // namespace calot::gui
