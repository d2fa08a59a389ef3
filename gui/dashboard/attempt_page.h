// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "gui/attempt/long_work.h"
#include "gui/dashboard/page_parts.h"
#include "gui/dashboard/recording_view.h"

namespace calot::gui {

class FigurePanel;
class VerdictCard;

/// One attempt: left its picture over one time line of phases, errors and forces; right the verdict, the figures that
/// count against a norm, and all others. Each sentence, figure, event and trace leads to its moment.
class AttemptPage : public CohortPage {
  Q_OBJECT
 public:
  AttemptPage();

  /// Makes ready what draws, before there is an attempt.
  void prepare() { recording_->prepare(); }
  /// Reads what belongs to the attempt when the page is visible.
  void setAttempt(std::shared_ptr<const CohortDocument> document, const analytics::AttemptRow& attempt);
  void clear();
  [[nodiscard]] FigurePanel& figures() { return *figures_; }
  /// True if everything readable of the attempt was read, and the replay is at its target.
  [[nodiscard]] bool settled() const { return recording_->settled(); }
  [[nodiscard]] Replay& replay() { return recording_->replay(); }
  /// Writes the attempt's sheet on a thread of its own. @pre an attempt is shown
  void writeSheet(const std::filesystem::path& file);
  /// The sheet, made on a thread of its own.
  bool makeDocument(const Taker& take) override;
  [[nodiscard]] LongWork& work() { return work_; }

 public slots:
  /// Asks where the recording is.
  void askForRecording();
  /// Asks for a file, and writes the sheet to it when the recording was read.
  void askForSheet();

 signals:
  void sheetWritten(const QString& text);
  void normRequested();
  /// Somebody is to go on from a moment of the attempt. @param time s
  void continuationRequested(const QString& recording, double time);

 private:
  void read() override;
  void connectParts();
  void whenRead(std::function<void()> action);  ///< once the recording was read; at once without one
  void sayMissing();                            ///< of the recording
  void startSheet(const QString& what,
                  std::function<QString(const analytics::ReportDocument&, LongWork::Control&)> then);

  std::optional<analytics::AttemptRow> attempt_;
  LongWork work_;
  std::function<void()> printed_;                    ///< hands over what work_ makes for paper
  std::vector<std::function<void()>> afterReading_;  ///< what waits for the recording to be read
  WorkStrip* strip_;
  AttemptBanner* banner_;
  VerdictCard* verdict_;
  FigurePanel* figures_;
  RecordingView* recording_;
  QPushButton *find_, *goOn_;
  TraceChart* force_;
};

}  // namespace calot::gui
