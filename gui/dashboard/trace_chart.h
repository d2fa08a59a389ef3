// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <QPixmap>
#include <QWidget>
#include <vector>

#include "gui/dashboard/time_scale.h"
#include "sim/scene/samples.h"

namespace calot::gui {

/// One quantity of both hands over the attempt's time, on the timeline's scale, with a line where the replay stands. A
/// click goes to that moment. The left hand is solid, the right one dashed.
///
/// Axes and lines are painted once for a size and kept: the replay moves the line thirty times a second.
class TraceChart : public QWidget {
  Q_OBJECT
 public:
  TraceChart(const QString& name, QString title, QWidget* parent = nullptr);
  /// @param values per hand, in bins of `bin` seconds; in the displayed unit
  void setTraces(double seconds, double bin, std::array<std::vector<double>, handCount> values);
  void clear() { setTraces(0.0, 1.0, {}); }
  void setPosition(double time);

  [[nodiscard]] const std::array<std::vector<double>, handCount>& values() const { return values_; }
  [[nodiscard]] QSize sizeHint() const override { return {600, std::min(104, theme::inType(96))}; }
  [[nodiscard]] QSize minimumSizeHint() const override { return {200, theme::inType(46)}; }

 signals:
  void timeChosen(double time);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;
  void changeEvent(QEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;

 private:
  [[nodiscard]] TimeScale scale() const { return {seconds_, static_cast<double>(width())}; }
  [[nodiscard]] QRectF plot() const;
  void paintAxes(QPainter& painter) const;
  void paintTrace(QPainter& painter, std::size_t hand) const;

  QString title_;
  double seconds_ = 0.0, bin_ = 1.0, position_ = 0.0;
  double top_ = 1.0;  ///< highest number of the axis
  std::array<std::vector<double>, handCount> values_;
  QPixmap painted_;  ///< all but the line; null: to be painted
};

/// The end of an axis from 0 that holds `largest`: 1, 2, 4, 5 or 8 times a power of ten, so that its half is short to
/// write, too. @pre largest >= 0; 0 gives 1
[[nodiscard]] double axisTop(double largest);

}  // namespace calot::gui
