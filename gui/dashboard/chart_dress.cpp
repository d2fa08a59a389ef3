// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/chart_dress.h"

#include <algorithm>
#include <cmath>
#include <QApplication>
#include <QtCharts/QAbstractAxis>
#include <QtCharts/QLegend>

#include "gui/attempt/theme.h"

namespace calot::gui {

void dress(QChart& chart) {
  const QFont font = QApplication::font();
  QFont bold = font;
  bold.setBold(true);
  chart.setBackgroundBrush(theme::surface());
  chart.setBackgroundRoundness(0.0);
  chart.setTitleBrush(theme::text());
  chart.setTitleFont(bold);
  chart.legend()->setLabelColor(theme::text());
  chart.legend()->setFont(font);
  for (QAbstractAxis* axis : chart.axes()) {
    axis->setLabelsColor(theme::text());
    axis->setLabelsFont(font);
    axis->setTitleBrush(theme::text());
    axis->setTitleFont(font);
    axis->setLinePenColor(theme::muted());
    axis->setGridLineColor(theme::grid());
  }
}

AxisSpan axisSpan(double lower, double upper) {
  constexpr double room = 0.06;
  constexpr double wantedTicks = 5.0;
  const double length = upper > lower ? upper - lower : std::max(1e-9, 0.2 * std::abs(upper));
  const double beside = upper > lower ? room * length : 0.5 * (length > 1e-9 ? length : 2.0);
  AxisSpan span{lower - beside, upper + beside, 1.0};
  // What cannot be below zero is not shown there.
  if (lower >= 0.0) span.from = std::max(0.0, span.from);
  const double wide = (span.to - span.from) / wantedTicks;
  const double power = std::pow(10.0, std::floor(std::log10(wide)));
  span.interval = 10.0 * power;
  for (const double step : {1.0, 2.0, 5.0}) {
    if (wide <= step * power * (1.0 + 1e-9)) {
      span.interval = step * power;
      break;
    }
  }
  return span;
}

}  // namespace calot::gui
