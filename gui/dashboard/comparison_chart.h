// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gui/dashboard/comparison.h"
#include "gui/dashboard/dot_chart.h"

namespace calot::gui {

/// Points of every attempt beside a box (quartiles, median, whiskers to the extremes) for each group; a group of fewer
/// than five has its median alone. People are circles, performers diamonds, so that the difference does not hang on
/// colour. With synthetic points the chart bears a watermark.
class ComparisonChart : public DotChart {
  Q_OBJECT
 public:
  explicit ComparisonChart(QWidget* parent = nullptr);
  void showComparison(const Comparison& comparison, const QString& title);

 protected:
  void redraw() override;

 private:
  Comparison comparison_;
  QString title_;
};

}  // namespace calot::gui
