// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/comparison_chart.h"

#include <algorithm>
#include <QtCharts/QBarCategoryAxis>
#include <QtCharts/QBoxPlotSeries>
#include <QtCharts/QBoxSet>

#include "gui/attempt/theme.h"
#include "gui/attempt/words.h"

namespace calot::gui {
namespace {

constexpr std::size_t maxDots = 500;   // of all groups: more take longer to draw than an interface may wait
constexpr std::size_t maxLabels = 40;  // more would cover each other
constexpr std::size_t fewestForBox = 5;

QBoxPlotSeries* boxesOf(const Comparison& comparison) {
  auto* series = new QBoxPlotSeries;
  series->setName("quartiles and extremes");
  series->setBoxWidth(0.35);
  for (const ComparisonGroup& group : comparison.group) {
    auto* set = new QBoxSet(QString::fromStdString(group.name));
    const bool box = group.point.size() >= fewestForBox;
    set->setValue(QBoxSet::LowerExtreme, box ? group.smallest : group.median);
    set->setValue(QBoxSet::LowerQuartile, box ? group.lowerQuartile : group.median);
    set->setValue(QBoxSet::Median, group.median);
    set->setValue(QBoxSet::UpperQuartile, box ? group.upperQuartile : group.median);
    set->setValue(QBoxSet::UpperExtreme, box ? group.largest : group.median);
    series->append(set);
  }
  series->setBrush(theme::box());
  series->setPen(QPen(theme::text(), comparison.group.size() <= maxLabels ? 1.5 : 1.0));
  return series;
}

QAbstractAxis* namedGroups(const Comparison& comparison) {
  auto* axis = new QBarCategoryAxis;
  // In two lines: Qt Charts cuts off a long label though there is space.
  for (const ComparisonGroup& group : comparison.group)
    axis->append(
        QString("%1<br>n = %2").arg(QString::fromStdString(group.name).toHtmlEscaped()).arg(group.point.size()));
  return axis;
}

QAbstractAxis* namelessGroups(const Comparison& comparison) {
  auto* axis = new QValueAxis;
  axis->setRange(-0.5, static_cast<double>(comparison.group.size()) - 0.5);
  axis->setLabelsVisible(false);
  axis->setGridLineVisible(false);
  return axis;
}

QScatterSeries* comparisonSeries(bool synthetic) {
  auto* series = new QScatterSeries;
  series->setName(synthetic ? "performer (synthetic)" : "attempt");
  series->setMarkerShape(synthetic ? QScatterSeries::MarkerShapeRotatedRectangle : QScatterSeries::MarkerShapeCircle);
  series->setMarkerSize(10.0);
  series->setColor(synthetic ? theme::second() : theme::first());
  series->setBorderColor(theme::surface());
  return series;
}

/// A dot for one attempt in so many.
std::size_t strideOf(const Comparison& comparison) {
  std::size_t points = 0;
  for (const ComparisonGroup& group : comparison.group) points += group.point.size();
  return 1 + points / maxDots;
}

std::vector<DotChart::Dot> comparisonDots(const Comparison& comparison, bool synthetic) {
  const std::size_t stride = strideOf(comparison);
  std::vector<DotChart::Dot> dots;
  const QString unit = QString::fromStdString(comparison.unit);
  for (std::size_t g = 0; g < comparison.group.size(); ++g) {
    const std::vector<ComparisonPoint>& points = comparison.group[g].point;
    for (std::size_t i = 0; i < points.size(); i += stride) {
      if (points[i].synthetic != synthetic) continue;
      // Neighbours in value stand at five different places beside the box, always the same ones.
      const double aside = 0.05 * (static_cast<double>(2 * (i / stride) % 5) - 2.0);
      dots.push_back({{static_cast<double>(g) + 0.32 + aside, points[i].value},
                      QString::fromStdString(points[i].attempt),
                      QString("%1: %2 %3\n%4")
                          .arg(QString::fromStdString(comparison.group[g].name), numberText(points[i].value), unit,
                               QString::fromStdString(points[i].attempt))});
    }
  }
  return dots;
}

}  // namespace

ComparisonChart::ComparisonChart(QWidget* parent) : DotChart("comparison-chart", "Attempts by group", parent) {}

void ComparisonChart::showComparison(const Comparison& comparison, const QString& title) {
  comparison_ = comparison;
  title_ = title;
  redraw();
}

void ComparisonChart::redraw() {
  clearChart();
  const std::size_t stride = strideOf(comparison_);
  const bool labelled = comparison_.group.size() <= maxLabels;
  QStringList less;
  if (stride > 1) less += QString("a dot for one attempt in %1").arg(stride);
  if (!labelled) less += QString("%1 groups, named by their dots").arg(comparison_.group.size());
  chart()->setTitle(comparison_.group.empty() ? title_ + ": nothing to show"
                    : less.isEmpty()          ? title_
                                              : title_ + " (" + less.join("; ") + ')');
  if (comparison_.group.empty()) {
    dress(*chart());
    return;
  }
  double lower = comparison_.group.front().smallest, upper = comparison_.group.front().largest;
  for (const ComparisonGroup& group : comparison_.group) {
    lower = std::min(lower, group.smallest);
    upper = std::max(upper, group.largest);
  }
  addAxes(labelled ? namedGroups(comparison_) : namelessGroups(comparison_),
          valueAxis(lower, upper, QString::fromStdString(comparison_.unit)));
  addSeries(boxesOf(comparison_));
  for (const bool synthetic : {false, true}) {
    const std::vector<Dot> dots = comparisonDots(comparison_, synthetic);
    if (!dots.empty()) addDots(comparisonSeries(synthetic), dots);
  }
  finishChart(comparison_.synthetic);
}

}  // namespace calot::gui
