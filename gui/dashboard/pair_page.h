// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>

#include "gui/attempt/pair_replay.h"
#include "gui/dashboard/page_parts.h"
#include "gui/dashboard/recording_view.h"

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

/// Begin of the first stretch of a phase; none where it was never reached.
std::optional<double> firstOf(const AttemptTrack& track, Phase phase);
/// Phases that both have, in the procedure's order.
std::vector<Phase> commonPhases(const AttemptTrack& a, const AttemptTrack& b);

/// Two recordings side by side in step: an expert's beside a trainee's, from their starts or from a phase on; or a
/// branch beside its parent, from where it left it, with what it did otherwise in figures.
class PairPage : public CohortPage {
  Q_OBJECT
 public:
  PairPage();
  ~PairPage() override;
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
  void showTraces();
  void showFigures();
  [[nodiscard]] bool bothOpen() const { return sides_[0]->isOpen() && sides_[1]->isOpen(); }

  std::array<PairSide*, 2> sides_;
  std::unique_ptr<PairReplay> pair_;
  TraceChart* traces_;
  QComboBox *trace_, *from_;
  QLabel* figures_;
};

}  // namespace calot::gui
