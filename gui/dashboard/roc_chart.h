// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QtCharts/QChartView>

#include "gui/dashboard/study_view.h"

namespace calot::gui {

/// A receiver operating characteristic with its diagonal of no skill.
class RocChart : public QChartView {
  Q_OBJECT
 public:
  explicit RocChart(QWidget* parent = nullptr);
  void showCurve(const RocCurve& curve, const QString& title);
  void clear(const QString& title);

 protected:
  void changeEvent(QEvent* event) override;
};

}  // namespace calot::gui
