// SPDX-License-Identifier: GPL-3.0-or-later
// Colours of charts and timelines: Okabe and Ito's set, told apart by people with any of the common colour-vision
// deficiencies. Sign, shape or word carries every meaning beside them.
#pragma once

#include <optional>
#include <QColor>
#include <QWidget>
#include <utility>
#include <vector>

#include "gui/attempt/attempt_recording.h"
#include "gui/dashboard/time_scale.h"
#include "sim/judgement/judge.h"

namespace calot::gui {

/// Phases as named stretches, events below them (errors as filled triangles, others as bars), and where the replay
/// stands. A click goes to that moment, on an event to it.
class TimelineBar : public QWidget {
  Q_OBJECT
 public:
  explicit TimelineBar(QWidget* parent = nullptr);
  void setTrack(AttemptTrack track);
  /// Text shown without a track.
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

namespace calot::gui::palette {

inline const QColor blue(0x00, 0x72, 0xb2);
inline const QColor skyBlue(0x56, 0xb4, 0xe9);
inline const QColor orange(0xe6, 0x9f, 0x00);
inline const QColor grey(0xb8, 0xb8, 0xb8);
inline const QColor darkText(0x22, 0x22, 0x22);

inline QColor ofPhase(Phase phase) {
  switch (phase) {
    case Phase::identification:
      return skyBlue;
    case Phase::clipping:
      return orange;
    case Phase::cutting:
      return QColor(0xf0, 0xe4, 0x42);
    case Phase::dissection:
      return QColor(0x7f, 0xd0, 0xb8);
    case Phase::none:
    case Phase::done:
      return QColor(0xd8, 0xd8, 0xd8);
  }
  return grey;
}

}  // namespace calot::gui::palette
