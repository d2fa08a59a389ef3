// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <QWidget>

#include "gui/attempt/long_work.h"
#include "gui/attempt/replay_transport.h"
#include "gui/dashboard/cohort_document.h"
#include "gui/dashboard/recording_reader.h"

class QPushButton;

namespace calot::gui {

class AttemptBanner;
class FigurePanel;
class ScenePictureWidget;
class SummaryPanel;
class TimelineBar;
class TraceChart;
class TransportBar;
class WorkStrip;

/// One attempt: what an instructor wants to know first, in words; its checkpoints within a norm, timeline, traces and
/// replay. A click on a figure, an event or a trace
/// shows that moment.
class AttemptPage : public QWidget {
  Q_OBJECT
 public:
  explicit AttemptPage(QWidget* parent = nullptr);
  ~AttemptPage() override;

  /// Reads what belongs to the attempt when the page is visible.
  void setAttempt(std::shared_ptr<const CohortDocument> document, const analytics::AttemptRow& attempt);
  void clear();
  [[nodiscard]] FigurePanel& figures() { return *figures_; }
  /// True if everything readable of the attempt was read, and the replay is at its target.
  [[nodiscard]] bool settled() const;
  [[nodiscard]] Replay& replay() { return *replay_; }
  /// Writes the attempt on one page, or against its norm, on a thread of its own. @pre an attempt is shown
  void writeSheet(const std::filesystem::path& file, bool onePage);
  [[nodiscard]] LongWork& work() { return work_; }

 public slots:
  /// Asks where the recording is.
  void askForRecording();

 signals:
  void problem(const QString& message);
  void sheetWritten(const QString& text);

 protected:
  void showEvent(QShowEvent* event) override;
  void hideEvent(QHideEvent* event) override;

 private:
  QWidget* buildReplay();
  void connectParts();
  void askForSheet(bool onePage);
  void load();
  void openRecording(const std::filesystem::path& file);
  void showMissingRecording();
  void showPosition();
  void takeTrack(const AttemptTrack& track);
  void takeMoments(const std::vector<analytics::FigureMoments>& moments);

  bool reading_ = false;  ///< of recording or moments something is still to come
  std::shared_ptr<const CohortDocument> document_;
  std::optional<analytics::AttemptRow> attempt_;
  bool loaded_ = false;
  std::filesystem::path file_;

  LongWork work_;
  WorkStrip* strip_ = nullptr;
  AttemptBanner* banner_ = nullptr;
  SummaryPanel* summary_ = nullptr;
  FigurePanel* figures_ = nullptr;
  ScenePictureWidget* picture_ = nullptr;
  QPushButton* find_ = nullptr;
  TimelineBar* timeline_ = nullptr;
  TraceChart* force_ = nullptr;
  TraceChart* speed_ = nullptr;
  std::unique_ptr<Replay> replay_;
  std::unique_ptr<RecordingReader> reader_;
};

}  // namespace calot::gui
