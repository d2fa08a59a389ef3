// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QStyledItemDelegate>

namespace calot::gui {

/// Draws where a figure stands in a norm: the competent members' 10th to 90th percentile as a pale bar, their quartiles
/// as a darker one, median as a line, the cut as a dashed line, the attempt's value as a diamond; the text beside it.
/// Figures without a band show their text alone.
class BandDelegate : public QStyledItemDelegate {
  Q_OBJECT
 public:
  using QStyledItemDelegate::QStyledItemDelegate;
  void paint(QPainter* painter, const QStyleOptionViewItem& option, const QModelIndex& index) const override;
};

}  // namespace calot::gui
