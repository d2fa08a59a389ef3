// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <QWidget>
#include <string>
#include <utility>
#include <vector>

#include "analytics/assessment/moments.h"
#include "gui/attempt/long_work.h"
#include "gui/attempt/replay_player.h"
#include "gui/attempt/replay_transport.h"
#include "gui/dashboard/cohort_document.h"
#include "gui/dashboard/timeline.h"
#include "gui/view/free_view.h"

class QPushButton;

namespace calot::gui {

/// The recording of an attempt: the picture of its replay, beside it one from anywhere on request, and its timeline.
/// The recording is read on a worker thread: its timeline, then the moments of figures. Pauses where it is not seen.
class RecordingView : public QWidget {
  Q_OBJECT
 public:
  using Figures = std::vector<std::pair<std::string, std::string>>;  ///< checkpoint and subject
  struct Parts {
    bool transport = true, timeline = true;  ///< without a timeline nothing is read
  };

  explicit RecordingView(Parts with);
  ~RecordingView() override;

  /// Looks for the attempt's recording beside the cohort and in the folders that are known, on another thread, and
  /// opens it; else missing() follows, and the view says so.
  void open(const analytics::AttemptRow& attempt, const CohortDocument& document, const Figures& figures = {});
  void openFile(const std::filesystem::path& file, const std::string& attempt, const Figures& figures = {});
  /// Faults name no file, which may name a person.
  void setBlinded(bool blinded) { blinded_ = blinded; }
  /// Shows texts instead of a recording.
  void close(const QString& text, const QString& timelineText = {});

  /// Makes ready what draws, before there is a recording.
  void prepare() { picture_->prepare(); }
  [[nodiscard]] Replay& replay() const { return *replay_; }
  void toggleFreeView();
  [[nodiscard]] bool isOpen() const { return replay_->isOpen(); }
  [[nodiscard]] TimelineBar& timeline() const { return *timeline_; }
  [[nodiscard]] const QString& text() const { return text_; }                ///< that stood last in place of a picture
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }  ///< that was opened last, or empty
  [[nodiscard]] const std::optional<AttemptTrack>& track() const { return track_; }  ///< once it was read
  [[nodiscard]] bool reading() const { return busy_; }  ///< something is still to come of the recording
  /// True if everything readable was read and the replay is at its target, or there is no recording.
  [[nodiscard]] bool settled() const;

 signals:
  void missing();  ///< the recording was not found
  void opened();
  /// A picture of the replay came on the screen. @param time since the attempt's start (s)
  void pictureShown(double time);
  void trackRead(const calot::gui::AttemptTrack& track);
  void momentsFound(const std::vector<calot::analytics::FigureMoments>& moments);
  void failed();  ///< to open, or to be read: why stands in the view

 protected:
  void hideEvent(QHideEvent* event) override;

 private:
  void startTrack();
  void startMoments();
  void fail(const QString& timelineText);
  void say(const QString& text);

  QString text_;
  std::filesystem::path file_;
  Figures figures_;
  std::optional<AttemptTrack> track_;
  bool reads_;
  bool busy_ = false;
  bool blinded_ = false;
  ScenePictureWidget* picture_;
  FreeView* free_;  ///< beside the endoscope's, where it is asked for
  QPushButton* toggle_;
  TimelineBar* timeline_;
  std::unique_ptr<Replay> replay_;
  std::function<void()> take_;  ///< what work_ reads
  LongWork work_;
  Background finder_;
};

}  // namespace calot::gui
