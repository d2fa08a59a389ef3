// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <QWidget>

#include "gui/dashboard/cohort_document.h"
#include "gui/dashboard/pair_side.h"

class QComboBox;
class QLabel;
class QSlider;
class QTimer;
class QToolButton;

namespace calot::gui {

class TraceChart;

/// Two recordings side by side in step: an expert's beside a trainee's, from their starts or from a phase on.
class PairPage : public QWidget {
  Q_OBJECT
 public:
  explicit PairPage(QWidget* parent = nullptr);
  /// @pre not null
  void setDocument(std::shared_ptr<const CohortDocument> document);
  /// Puts an attempt on one side: 0 left, 1 right.
  void setAttempt(std::size_t side, const std::string& uuid);
  /// Where a side is still free: puts the newest attempts on both.
  void chooseTwo();
  void showMiddle();  ///< the middle of what both show, where both are open
  /// True if both are at their targets, with their timelines.
  [[nodiscard]] bool settled() const;
  [[nodiscard]] Replay& replay(std::size_t side) { return sides_[side]->replay(); }

 protected:
  void showEvent(QShowEvent* event) override;
  void hideEvent(QHideEvent* event) override;

 private:
  QWidget* buildTransport();
  void fillSides();
  void fillAlignments();
  void align();
  void goTo(double common);
  void play(bool playing);
  void onTick();
  void showTraces();
  void showTime();
  [[nodiscard]] bool bothOpen() const { return sides_[0]->isOpen() && sides_[1]->isOpen(); }

  std::shared_ptr<const CohortDocument> document_;
  std::array<PairSide*, 2> sides_;
  std::optional<PairAlignment> alignment_;
  double common_ = 0.0;
  bool playing_ = false;
  std::chrono::steady_clock::time_point clockBegin_;
  double clockCommon_ = 0.0;
  bool filled_ = false;

  TraceChart* traces_ = nullptr;
  QComboBox* trace_ = nullptr;
  QComboBox* from_ = nullptr;
  QComboBox* speed_ = nullptr;
  QToolButton* play_ = nullptr;
  QSlider* scrub_ = nullptr;
  QLabel* time_ = nullptr;
  QTimer* tick_ = nullptr;
};

}  // namespace calot::gui
