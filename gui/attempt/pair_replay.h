// SPDX-License-Identifier: GPL-3.0-or-later
// Two replays in step: two attempts from a moment that both have, or a branch beside its parent.
#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <QTimer>
#include <QWidget>

#include "gui/attempt/replay_transport.h"

namespace calot::gui {

/// A common time, 0 at the moment that both are aligned by: a recording's own time is common + offset.
class PairAlignment {
 public:
  /// @param seconds lengths of both; @param offsets own times of the moment that they are aligned by
  PairAlignment(std::array<double, 2> seconds, std::array<double, 2> offsets);

  /// Common times in which at least one of them runs.
  [[nodiscard]] double begin() const { return begin_; }
  [[nodiscard]] double end() const { return end_; }
  /// A recording's own time, clamped: where one has ended its last picture stands.
  [[nodiscard]] double own(std::size_t which, double common) const;
  [[nodiscard]] double common(std::size_t which, double own) const { return own - offsets_[which]; }
  [[nodiscard]] const std::array<double, 2>& offsets() const { return offsets_; }
  /// True if a recording runs at a common time, rather than waiting for its begin or standing at its end.
  [[nodiscard]] bool runs(std::size_t which, double common) const;
  /// From the moment that they are aligned by to the end of the shorter one (s).
  [[nodiscard]] double shared() const;

 private:
  std::array<double, 2> seconds_, offsets_;
  double begin_, end_;
};

/// Drives two replays by one clock. Without an alignment it does nothing.
class PairReplay : public QObject {
  Q_OBJECT
 public:
  /// @param left, right outlive this
  PairReplay(Replay& left, Replay& right);

  /// Aligns both and goes to common time 0. @pre both are open
  void align(std::array<double, 2> offsets);
  void clear();
  [[nodiscard]] const std::optional<PairAlignment>& alignment() const { return alignment_; }
  [[nodiscard]] double common() const { return common_; }
  [[nodiscard]] bool playing() const { return playing_; }

  void goTo(double common);
  void play(bool playing);
  void setSpeed(double speed);

 signals:
  void changed();  ///< alignment, position, or whether it plays

 private:
  void onTick();

  std::array<Replay*, 2> replay_;
  std::optional<PairAlignment> alignment_;
  double common_ = 0.0, speed_ = 1.0;
  bool playing_ = false;
  std::chrono::steady_clock::time_point clockBegin_;
  double clockCommon_ = 0.0;
  QTimer tick_;
};

/// Play and pause both, scrub, speed, and where they stand.
class PairTransport : public QWidget {
  Q_OBJECT
 public:
  /// @param pair outlives this
  explicit PairTransport(PairReplay& pair);

 private:
  void show();

  PairReplay& pair_;
  QToolButton* play_;
  QSlider* scrub_;
  QLabel* time_;
  QComboBox* speed_;
};

}  // namespace calot::gui
