// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <QPixmap>
#include <QString>
#include <QWidget>

#include "analytics/report/plots.h"

namespace calot::gui {

/// Shows a plot as reports draw it, in the application's letters and colours. A click on a mark opens its attempt; from
/// the keyboard arrows choose a mark, Enter opens it.
class PlotView : public QWidget {
  Q_OBJECT
  Q_PROPERTY(bool watermark READ hasWatermark)
 public:
  using Draw = std::function<std::optional<analytics::Drawing>(const analytics::PlotFrame& frame)>;
  PlotView(const char* name, const char* spokenName);
  /// @param draw called again when size or letters change; without a drawing, the title stands alone
  void show(const QString& title, Draw draw, bool synthetic = false);
  /// Makes the widget as high as this (units of the drawing), for a drawing whose height follows from what it shows.
  void keepHeight(double units);
  /// Title alone.
  void clear(const QString& title) { show(title, {}); }

  [[nodiscard]] bool hasWatermark() const { return synthetic_; }
  [[nodiscard]] const analytics::Drawing& drawing();
  /// Those of the drawing, from left to right, then from top to bottom.
  [[nodiscard]] const std::vector<analytics::DrawnMark>& marks() { return drawing().marks; }
  /// A mark's position on the widget.
  [[nodiscard]] QPointF placeOf(const analytics::DrawnMark& mark) const;
  [[nodiscard]] QSize sizeHint() const override { return {480, 320}; }
  [[nodiscard]] QSize minimumSizeHint() const override { return {240, 150}; }

 signals:
  void attemptChosen(const QString& key);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;
  void changeEvent(QEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;

 private:
  [[nodiscard]] double pixelsPerUnit() const;
  [[nodiscard]] const analytics::DrawnMark* markAt(const QPointF& place);
  void choose(int mark);

  QString title_;
  Draw draw_;
  bool synthetic_ = false;
  std::optional<analytics::Drawing> drawing_;  ///< none: to be drawn
  QPixmap painted_;                            ///< null: to be painted
  int chosen_ = -1;                            ///< index of a mark, or -1
  double leastHeight_ = 180.0;                 ///< units: a smaller plot would cut its letters off
};

/// The colour on the screen of a drawing's colour, which is meant for white paper.
[[nodiscard]] QColor onScreen(const QColor& colour);

}  // namespace calot::gui
