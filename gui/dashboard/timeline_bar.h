// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <QWidget>
#include <utility>
#include <vector>

#include "gui/attempt/attempt_track.h"
#include "gui/dashboard/time_scale.h"

namespace calot::gui {

/// Phases as named stretches, events below them (errors as filled triangles, others as bars), and where the replay
/// stands. A click goes to that moment, on an event to it.
class TimelineBar : public QWidget {
  Q_OBJECT
 public:
  explicit TimelineBar(QWidget* parent = nullptr);
  void setTrack(AttemptTrack track);
  /// What stands there without a track.
  void setText(const QString& text);
  void setPosition(double time);
  /// Windows to be marked: a figure's moments.
  void setMarked(std::vector<std::pair<double, double>> windows);

  [[nodiscard]] QSize sizeHint() const override { return {600, theme::inType(52)}; }
  [[nodiscard]] QSize minimumSizeHint() const override { return {200, theme::inType(52)}; }

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
  QString text_;
  double position_ = 0.0;
  std::vector<std::pair<double, double>> marked_;
};

}  // namespace calot::gui
