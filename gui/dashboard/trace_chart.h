// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <QtCharts/QChartView>
#include <vector>

#include "gui/dashboard/time_scale.h"
#include "sim/scene/samples.h"

class QGraphicsLineItem;
class QLineSeries;
class QValueAxis;

namespace calot::gui {

/// One quantity of both hands over the attempt's time, on the timeline's scale, with a line where the replay stands. A
/// click goes to that moment. The left hand is solid, the right one dashed.
class TraceChart : public QChartView {
  Q_OBJECT
 public:
  TraceChart(const QString& name, const QString& title, QWidget* parent = nullptr);
  /// @param values per hand, in bins of `bin` seconds; in the displayed unit
  void setTraces(double seconds, double bin, const std::array<std::vector<double>, handCount>& values);
  void clear();
  void setPosition(double time);

  [[nodiscard]] QSize sizeHint() const override { return {600, 104}; }
  [[nodiscard]] QSize minimumSizeHint() const override { return {200, 84}; }

 signals:
  void timeChosen(double time);

 protected:
  void resizeEvent(QResizeEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;

 private:
  [[nodiscard]] TimeScale scale() const { return {seconds_, static_cast<double>(viewport()->width())}; }
  void place();

  double seconds_ = 0.0, position_ = 0.0;
  std::array<QLineSeries*, handCount> series_{};
  QValueAxis* time_;
  QValueAxis* value_;
  QGraphicsLineItem* cursor_;
};

}  // namespace calot::gui
