// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>

#include "gui/attempt/replay.h"

class QComboBox;
class QLabel;
class QSlider;
class QToolButton;

namespace calot::gui {

/// Buttons of a replay: play and pause, single steps, scrub, speed, and where it stands.
class TransportBar : public QWidget {
  Q_OBJECT
 public:
  /// @param replay outlives the bar
  explicit TransportBar(Replay& replay, QWidget* parent = nullptr);

 private:
  void show(const PlayerPosition& position);
  void setReady(bool ready);

  Replay& replay_;
  QToolButton* play_;
  QToolButton* back_;
  QToolButton* forward_;
  QSlider* scrub_;
  QComboBox* speed_;
  QLabel* time_;
};

}  // namespace calot::gui
