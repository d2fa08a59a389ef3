// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gui/dashboard/dot_chart.h"
#include "gui/dashboard/trainee_history.h"

namespace calot::gui {

/// Values over the number of the attempt, with the fitted curve, its band and a norm's cut. Attempts that are not in
/// the curve are hollow. What a performer made bears a watermark.
class HistoryChart : public DotChart {
  Q_OBJECT
 public:
  explicit HistoryChart(QWidget* parent = nullptr);
  void showHistory(const TraineeHistory& history, const QString& title);

 protected:
  void redraw() override;

 private:
  TraineeHistory history_;
  QString title_;
};

}  // namespace calot::gui
