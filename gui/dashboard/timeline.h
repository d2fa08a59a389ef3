// SPDX-License-Identifier: GPL-3.0-or-later
// Timeline and traces of an attempt, one below the other on one scale.
#pragma once

#include <algorithm>
#include <array>
#include <QPixmap>
#include <QWidget>
#include <utility>
#include <vector>

#include "gui/attempt/replay_player.h"
#include "gui/attempt/widget_parts.h"
#include "sim/scene/samples.h"

namespace calot::gui {

/// Position of a time on a page.
struct TimeScale {
  static constexpr double rightMargin = 16.0;  ///< pixels
  /// Pixels for an axis and its numbers.
  [[nodiscard]] static double leftMargin() { return theme::inType(64); }

  double seconds = 0.0;  ///< the whole, from 0
  double width = 0.0;    ///< of the widget (pixels)

  [[nodiscard]] double span() const { return std::max(1.0, width - leftMargin() - rightMargin); }
  [[nodiscard]] double x(double time) const { return leftMargin() + (seconds > 0.0 ? time / seconds * span() : 0.0); }
  /// Clamped to the attempt.
  [[nodiscard]] double time(double x) const { return std::clamp((x - leftMargin()) / span(), 0.0, 1.0) * seconds; }
};

/// Phases as named stretches; below them, each in a lane, errors by severity (triangles) and other events (bars); and
/// where the replay stands. A click goes to that moment, on an event to it.
class TimelineBar : public QWidget {
  Q_OBJECT
 public:
  TimelineBar();
  void setTrack(AttemptTrack track);
  /// Text shown without a track.
  void setText(const QString& text);
  void setPosition(double time);
  /// Windows to be marked: a figure's moments.
  void setMarked(std::vector<std::pair<double, double>> windows);

  [[nodiscard]] QSize sizeHint() const override;
  [[nodiscard]] QSize minimumSizeHint() const override { return {200, sizeHint().height()}; }

 signals:
  void timeChosen(double time);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  bool event(QEvent* event) override;

 private:
  [[nodiscard]] TimeScale scale() const { return {track_.seconds, static_cast<double>(width())}; }
  [[nodiscard]] const TrackEvent* eventAt(const QPoint& at) const;

  AttemptTrack track_;
  double position_ = 0.0;
  std::vector<std::pair<double, double>> marked_;
};

/// One quantity of both hands over the attempt's time, on the timeline's scale, with a line where the replay stands. A
/// click goes to that moment. The left hand is solid, the right one dashed.
///
/// Axes and lines are painted once for a size and kept: the replay moves the line thirty times a second.
class TraceChart : public QWidget {
  Q_OBJECT
 public:
  TraceChart(const QString& name, QString title);
  /// @param values per hand, in bins of `bin` seconds; in the displayed unit
  void setTraces(double seconds, double bin, std::array<std::vector<double>, handCount> values);
  void clear() { setTraces(0.0, 1.0, {}); }
  void setPosition(double time);

  [[nodiscard]] const std::array<std::vector<double>, handCount>& values() const { return values_; }
  [[nodiscard]] QSize sizeHint() const override { return {600, std::min(104, theme::inType(96))}; }
  [[nodiscard]] QSize minimumSizeHint() const override { return {200, theme::inType(46)}; }

 signals:
  void timeChosen(double time);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;
  void changeEvent(QEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;

 private:
  [[nodiscard]] TimeScale scale() const { return {seconds_, static_cast<double>(width())}; }
  [[nodiscard]] QRectF plot() const;
  void paintAxes(QPainter& painter) const;
  void paintTrace(QPainter& painter, std::size_t hand) const;

  QString title_;
  double seconds_ = 0.0, bin_ = 1.0, position_ = 0.0;
  double top_ = 1.0;  ///< highest number of the axis
  std::array<std::vector<double>, handCount> values_;
  QPixmap painted_;  ///< all but the line; null: to be painted
};

/// The end of an axis from 0 that holds `largest`: 1, 2, 4, 5 or 8 times a power of ten, so that its half is short to
/// write, too. @pre largest >= 0; 0 gives 1
[[nodiscard]] double axisTop(double largest);

}  // namespace calot::gui
