// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QtCharts/QChartView>

#include "gui/dashboard/trainee_history.h"
#include "gui/dashboard/watermark.h"

namespace calot::gui {

/// Values over the number of the attempt, with the fitted curve, its plateau and a norm's cut. Attempts that are not in
/// the curve are hollow. What a performer made bears a watermark.
class HistoryChart : public QChartView {
  Q_OBJECT
  Q_PROPERTY(bool watermark READ hasWatermark)
 public:
  explicit HistoryChart(QWidget* parent = nullptr);
  void showHistory(const TraineeHistory& history, const QString& title);
  [[nodiscard]] bool hasWatermark() const { return watermark_.isVisible(); }

 protected:
  void resizeEvent(QResizeEvent* event) override;

 private:
  Watermark watermark_;
};

}  // namespace calot::gui
