// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QPointF>
#include <QString>
#include <QtCharts/QChartView>
#include <QtCharts/QScatterSeries>
#include <QtCharts/QValueAxis>
#include <vector>

#include "gui/dashboard/chart_dress.h"
#include "gui/dashboard/watermark.h"

namespace calot::gui {

/// A chart whose dots are attempts. A click on one opens it; from the keyboard arrows choose a dot, Enter opens it.
class DotChart : public QChartView {
  Q_OBJECT
  Q_PROPERTY(bool watermark READ hasWatermark)
 public:
  struct Dot {
    QPointF at;       ///< in the axes' units
    QString attempt;  ///< uuid
    QString text;     ///< of the tool tip
  };
  explicit DotChart(const char* name, const char* spokenName, QWidget* parent = nullptr);
  [[nodiscard]] const std::vector<Dot>& dots() const { return dots_; }
  [[nodiscard]] bool hasWatermark() const { return watermark_.isVisible(); }
  /// Where a dot is on the widget.
  [[nodiscard]] QPointF placeOf(const Dot& dot) const;

 signals:
  void attemptChosen(const QString& uuid);

 protected:
  /// Draws what is shown anew: the colours have changed.
  virtual void redraw() = 0;
  void clearChart();
  /// @param series becomes the chart's; each of its dots is an attempt
  void addDots(QScatterSeries* series, const std::vector<Dot>& dots);
  void addAxes(QAbstractAxis* across, QAbstractAxis* up);
  void addSeries(QAbstractSeries* series);
  /// Behind the last series: colours, letters, and the mark of the chosen dot.
  void finishChart(bool synthetic);
  /// A vertical axis over these values, with its unit.
  [[nodiscard]] static QValueAxis* valueAxis(double lower, double upper, const QString& unit);

  void keyPressEvent(QKeyEvent* event) override;
  void changeEvent(QEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

 private:
  [[nodiscard]] const Dot* dotAt(const QPointF& value) const;
  void choose(int dot);

  Watermark watermark_;
  std::vector<Dot> dots_;
  QAbstractAxis* across_ = nullptr;
  QAbstractAxis* up_ = nullptr;
  QAbstractSeries* measure_ = nullptr;  ///< by which places are found
  QScatterSeries* chosenMark_ = nullptr;
  int chosen_ = -1;
};

}  // namespace calot::gui
