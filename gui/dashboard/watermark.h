// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

class QGraphicsScene;
class QGraphicsSimpleTextItem;
class QSize;

namespace calot::gui {

/// "SYNTHETIC", pale and aslant over a chart that shows what performers made, whole in any size of the chart.
class Watermark {
 public:
  /// @param scene of the chart; owns what is drawn
  explicit Watermark(QGraphicsScene& scene);
  void setVisible(bool visible);
  [[nodiscard]] bool isVisible() const;
  /// The chart has this size now.
  void place(const QSize& chart);

 private:
  QGraphicsSimpleTextItem* item_;
};

}  // namespace calot::gui
