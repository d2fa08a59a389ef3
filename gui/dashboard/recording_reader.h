// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <QObject>
#include <string>
#include <utility>
#include <vector>

#include "analytics/assessment/moments.h"
#include "gui/attempt/attempt_recording.h"
#include "gui/attempt/long_work.h"

namespace calot::gui {

/// Reads a recording's timeline, then the moments of its figures, on a worker thread; signals come on the object's.
class RecordingReader : public QObject {
  Q_OBJECT
 public:
  using Figures = std::vector<std::pair<std::string, std::string>>;  ///< checkpoint and subject

  explicit RecordingReader(QObject* parent = nullptr);
  ~RecordingReader() override;
  /// Breaks off what it is at, without waiting for it, and begins anew.
  /// @pre the file was opened by openRecording()
  void read(const std::filesystem::path& file, const Figures& figures);
  void stop();

 signals:
  void progress(int percent);  ///< of both together
  void trackRead(const calot::gui::AttemptTrack& track);
  void momentsFound(const std::vector<calot::analytics::FigureMoments>& moments);
  void failed(const QString& reason);

 private:
  using Back = std::shared_ptr<Link<RecordingReader>>;
  static void run(const Back& back, const std::filesystem::path& file, const Figures& figures);

  Back back_;  ///< of what is being read
};

}  // namespace calot::gui
