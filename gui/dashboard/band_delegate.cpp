// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/band_delegate.h"

#include <algorithm>
#include <QApplication>
#include <QPainter>
#include <QStyle>
#include <utility>

#include "gui/attempt/figure_text.h"
#include "gui/attempt/widget_parts.h"
#include "gui/dashboard/checkpoint_table_model.h"

namespace calot::gui {
namespace {

constexpr int barWidth = 120;

void paintBand(QPainter& painter, const QRectF& box, const FigureStanding& standing) {
  const FigureStanding::Band& band = *standing.band;
  double low = band.p10, high = band.p90;
  for (const auto& number : {standing.value, standing.cut}) {
    if (!number) continue;
    low = std::min(low, *number);
    high = std::max(high, *number);
  }
  const double room = high > low ? 0.06 * (high - low) : 1.0;
  low -= room;
  high += room;
  const auto x = [&](double number) { return box.left() + (number - low) / (high - low) * box.width(); };
  const double middle = box.center().y();
  const auto bar = [&](double from, double to, double half, const QColor& colour) {
    painter.fillRect(QRectF(x(from), middle - half, std::max(1.0, x(to) - x(from)), 2.0 * half), colour);
  };
  bar(band.p10, band.p90, 3.0, theme::dark() ? QColor(0x2a, 0x4a, 0x60) : QColor(0xbf, 0xd9, 0xea));
  bar(band.p25, band.p75, 5.0, theme::dark() ? QColor(0x3c, 0x70, 0x94) : QColor(0x7f, 0xb4, 0xd6));
  painter.setPen(QPen(theme::text(), 1.5));
  painter.drawLine(QPointF(x(band.p50), middle - 6.0), QPointF(x(band.p50), middle + 6.0));
  if (standing.cut) {
    painter.setPen(QPen(theme::text(), 1.0, Qt::DashLine));
    painter.drawLine(QPointF(x(*standing.cut), box.top() + 1.0), QPointF(x(*standing.cut), box.bottom() - 1.0));
  }
  if (standing.value) {
    const double at = x(*standing.value);
    painter.setPen(QPen(theme::surface(), 1.0));
    painter.setBrush(standing.passed.value_or(true) ? theme::first() : theme::second());
    painter.drawPolygon(QPolygonF{
        {QPointF(at - 5.0, middle), QPointF(at, middle - 6.0), QPointF(at + 5.0, middle), QPointF(at, middle + 6.0)}});
  }
}

}  // namespace

void BandDelegate::paint(QPainter* painter, const QStyleOptionViewItem& option, const QModelIndex& index) const {
  const auto* standing =
      static_cast<const FigureStanding*>(index.data(CheckpointTableModel::standingRole).value<const void*>());
  if (standing == nullptr || !standing->band) {
    QStyledItemDelegate::paint(painter, option, index);
    return;
  }
  QStyleOptionViewItem item = option;
  initStyleOption(&item, index);
  const QString text = std::exchange(item.text, QString());
  const QStyle* style = option.widget != nullptr ? option.widget->style() : QApplication::style();
  style->drawControl(QStyle::CE_ItemViewItem, &item, painter, option.widget);
  painter->save();
  painter->setRenderHint(QPainter::Antialiasing);
  paintBand(*painter, QRectF(option.rect.left() + 4, option.rect.top(), barWidth, option.rect.height()), *standing);
  const bool selected = option.state.testFlag(QStyle::State_Selected);
  painter->setPen(option.palette.color(selected ? QPalette::HighlightedText : QPalette::Text));
  painter->drawText(option.rect.adjusted(barWidth + 12, 0, -4, 0), Qt::AlignVCenter | Qt::AlignLeft, text);
  painter->restore();
}

}  // namespace calot::gui
