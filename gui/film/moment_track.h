// SPDX-License-Identifier: GPL-3.0-or-later
// Recorded data shown with the frames: phase, events, checkpoints, paths of the tools.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analytics/checkpoints/collector.h"
#include "gui/render/smoke.h"
#include "gui/words/event_words.h"
#include "recorder/recorded_results.h"
#include "recorder/recording/reader.h"

namespace calot::gui {

/// Data of one moment of an attempt.
struct Moment {
  struct Line {
    std::string text;
    bool fault = false;
    double time = 0.0;  ///< when it happened (s)
  };
  struct Place {
    Vec3 p_W = Vec3::Zero();
    double time = 0.0;  ///< s
  };
  double time = 0.0;                              ///< s
  std::string phase;                              ///< "clipping", or empty
  std::deque<Line> events;                        ///< of the last eventSeconds, oldest first
  std::vector<std::string> checkpoints;           ///< "path-length left  412 mm"
  std::array<std::deque<Place>, handCount> path;  ///< of the simulated tips in the last pathSeconds, oldest first
  std::vector<Puff> smoke;

  static constexpr double eventSeconds = 5.0, pathSeconds = 3.0;
};

/// Reads the results of a recording's steps and sums up, from its first step on: judgement needs all of them.
class MomentTrack {
 public:
  /// @param checkpoints are asked for: they are computed as the track goes on
  /// @throws Error (invalid) for a golden recording, which holds no results of its steps; (damaged) where it can't be
  /// read
  MomentTrack(const std::filesystem::path& recording, bool checkpoints);

  /// Data after step n; forward only. @pre n is not before that of the last call, and below the recording's stepCount()
  [[nodiscard]] const Moment& at(std::uint64_t n);

 private:
  void add(const recorder::RecordedStep& step);
  void refreshCheckpoints(double time);

  recorder::Recording recording_;
  double stepSeconds_ = 0.01;
  SubjectNames names_;
  std::unique_ptr<analytics::CheckpointCollector> collector_;  ///< none: no checkpoints are asked for
  std::uint64_t next_ = 0;                                     ///< step to read
  std::optional<recorder::RecordedResults> results_;
  std::optional<Judge> judge_;
  Moment moment_;
  SmokeTrail smoke_;
  double checkpointsAt_ = -1.0;  ///< when they were last computed (s)
};

/// Per phase of the procedure (identification to dissection): when it first began (s), or -1. @throws Error (damaged)
[[nodiscard]] std::array<double, 4> phaseStarts(const std::filesystem::path& recording);

}  // namespace calot::gui
