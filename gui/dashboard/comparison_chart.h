// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QtCharts/QChartView>

#include "gui/dashboard/comparison.h"
#include "gui/dashboard/watermark.h"

namespace calot::gui {

/// Points of every attempt beside a box (quartiles, median, whiskers to the extremes) for each group; a group of fewer
/// than five has its median alone. People are circles, performers diamonds, so that the difference does not hang on
/// colour. With synthetic points the chart bears a watermark.
class ComparisonChart : public QChartView {
  Q_OBJECT
  Q_PROPERTY(bool watermark READ hasWatermark)
 public:
  explicit ComparisonChart(QWidget* parent = nullptr);
  void showComparison(const Comparison& comparison, const QString& title);
  [[nodiscard]] bool hasWatermark() const { return watermark_.isVisible(); }

 protected:
  void resizeEvent(QResizeEvent* event) override;

 private:
  Watermark watermark_;
};

}  // namespace calot::gui
