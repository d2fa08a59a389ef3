// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <QTimer>

#include "gui/dashboard/page_parts.h"
#include "gui/dashboard/recording_view.h"

class QSlider;
class QToolButton;

namespace calot::gui {

/// One of two recordings side by side: which attempt, its verification, its replay and its timeline.
class PairSide : public RecordingView {
  Q_OBJECT
 public:
  /// @param name of the choice: "left" or "right"
  explicit PairSide(const QString& name);

  /// Lists the document's attempts, the newest first, keeps the one that is chosen, and opens it.
  /// @pre not null
  void setDocument(std::shared_ptr<const CohortDocument> document);
  /// Chooses an attempt; while this is hidden, at the next setDocument().
  void choose(const std::string& uuid);
  /// If none is chosen: the n-th of the list, from 1 on.
  void chooseAnother(int n);
  [[nodiscard]] QComboBox* choiceBox() const { return choice_; }

 signals:
  void changing();  ///< another attempt is chosen, or none

 private:
  void openChosen();

  std::shared_ptr<const CohortDocument> document_;
  QComboBox* choice_;
  AttemptBanner* banner_;
  std::string uuid_;    ///< that is chosen
  std::string wanted_;  ///< to be chosen at the next setDocument()
  std::string opened_;  ///< whose recording was opened
};

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
  /// True if a recording runs at a common time, rather than waiting for its begin or standing at its end.
  [[nodiscard]] bool runs(std::size_t which, double common) const;

 private:
  std::array<double, 2> seconds_, offsets_;
  double begin_, end_;
};

/// Begin of the first stretch of a phase; none where it was never reached.
std::optional<double> firstOf(const AttemptTrack& track, Phase phase);
/// Phases that both have, in the procedure's order.
std::vector<Phase> commonPhases(const AttemptTrack& a, const AttemptTrack& b);

/// Two recordings side by side in step: an expert's beside a trainee's, from their starts or from a phase on.
class PairPage : public CohortPage {
  Q_OBJECT
 public:
  PairPage();
  /// Puts an attempt on one side: 0 left, 1 right.
  void setAttempt(std::size_t side, const std::string& uuid);
  /// If a side is still free: puts the newest attempts on both.
  void chooseTwo();
  void showMiddle();  ///< the middle of what both show, where both are open
  /// True if both are at their targets, with their timelines.
  [[nodiscard]] bool settled() const;
  [[nodiscard]] Replay& replay(std::size_t side) { return sides_[side]->replay(); }

 protected:
  void hideEvent(QHideEvent* event) override;

 private:
  void read() override;
  void fillAlignments();
  void align();
  void goTo(double common);
  void play(bool playing);
  void onTick();
  void showTraces();
  void showTime();
  [[nodiscard]] bool bothOpen() const { return sides_[0]->isOpen() && sides_[1]->isOpen(); }

  std::array<PairSide*, 2> sides_;
  std::optional<PairAlignment> alignment_;
  double common_ = 0.0;
  bool playing_ = false;
  std::chrono::steady_clock::time_point clockBegin_;
  double clockCommon_ = 0.0;

  TraceChart* traces_;
  QComboBox *trace_, *from_, *speed_;
  QToolButton* play_;
  QSlider* scrub_;
  QLabel* time_;
  QTimer tick_;
};

}  // namespace calot::gui
