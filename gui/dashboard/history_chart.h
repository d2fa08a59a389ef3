// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QtCharts/QChartView>

#include "gui/dashboard/trainee_history.h"

namespace calot::gui {

/// Values over the number of the attempt, with the fitted curve, its plateau and a norm's cut. Attempts that are not in
/// the curve are hollow.
class HistoryChart : public QChartView {
  Q_OBJECT
 public:
  explicit HistoryChart(QWidget* parent = nullptr);
  void showHistory(const TraineeHistory& history, const QString& title);
};

}  // namespace calot::gui
