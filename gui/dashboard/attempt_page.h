// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "gui/attempt/long_work.h"
#include "gui/dashboard/page_parts.h"
#include "gui/dashboard/recording_view.h"

namespace calot::gui {

class FigurePanel;
class SummaryPanel;

/// One attempt: what an instructor wants to know first, in words; its checkpoints within a norm, timeline, traces and
/// replay. A click on a figure, an event or a trace shows that moment.
class AttemptPage : public CohortPage {
  Q_OBJECT
 public:
  AttemptPage();

  /// Reads what belongs to the attempt when the page is visible.
  void setAttempt(std::shared_ptr<const CohortDocument> document, const analytics::AttemptRow& attempt);
  void clear();
  [[nodiscard]] FigurePanel& figures() { return *figures_; }
  /// True if everything readable of the attempt was read, and the replay is at its target.
  [[nodiscard]] bool settled() const { return recording_->settled(); }
  [[nodiscard]] Replay& replay() { return recording_->replay(); }
  /// Writes the attempt on one page, or against its norm, on a thread of its own. @pre an attempt is shown
  void writeSheet(const std::filesystem::path& file, bool onePage);
  [[nodiscard]] LongWork& work() { return work_; }

 public slots:
  /// Asks where the recording is.
  void askForRecording();

 signals:
  void sheetWritten(const QString& text);

 private:
  void read() override;
  void connectParts();
  void askForSheet(bool onePage);

  std::optional<analytics::AttemptRow> attempt_;
  LongWork work_;
  WorkStrip* strip_;
  AttemptBanner* banner_;
  SummaryPanel* summary_;
  FigurePanel* figures_;
  RecordingView* recording_;
  QPushButton* find_;
  TraceChart* force_;
  TraceChart* speed_;
};

}  // namespace calot::gui
