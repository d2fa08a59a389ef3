// SPDX-License-Identifier: GPL-3.0-or-later
// The recording behind an attempt: its course over time, and its replay. Knows no window.
#pragma once

#include <array>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "gui/words/event_words.h"
#include "recorder/recording/reader.h"
#include "recorder/replay.h"
#include "sim/scene/scene_view.h"

namespace calot::gui {

/// State shown by a replay.
struct PlayerPosition {
  std::uint64_t step = 0;   ///< the last step done
  std::uint64_t steps = 0;  ///< of the recording
  double time = 0.0;        ///< end of that step since the attempt's start (s)
  double seconds = 0.0;     ///< of the recording
  double speed = 1.0;       ///< asked for
  bool playing = false;
  bool settled = true;   ///< false: on the way to the moment that was asked for
  bool hopping = false;  ///< re-simulation cannot keep pace; from keyframe to keyframe
};

inline constexpr double slowestReplay = 0.1, fastestReplay = 16.0;  ///< times real time

/// A request to a replay: what it names changes.
struct ReplayWish {
  std::optional<double> time = {};   ///< to go there (s since the attempt's start); clamped
  int steps = 0;                     ///< then by this number, clamped; playing stops
  std::optional<bool> playing = {};  ///< true, at the end: from the start again
  std::optional<double> speed = {};  ///< clamped to slowestReplay and fastestReplay
};

/// Plays a recording by simulating it again, on a thread of its own. A moment is reached from the nearest keyframe; the
/// keyframe is shown at once where the way from there is long. Every picture is of a State that the recording gives;
/// its time is reported with it. Knows no window.
class ReplayPlayer {
 public:
  struct Receiver {
    /// On the player's thread. The view is changed by nobody any more.
    std::function<void(std::shared_ptr<const SceneView>, const PlayerPosition&)> moment;
    std::function<void(const std::string&)> failed;  ///< on the player's thread: one line; nothing more comes
    /// On the player's thread: the first step, while the rest of the file is still to be read. May be empty.
    std::function<void(std::shared_ptr<const SceneView>)> glimpse = {};
  };

  /// Opens the file and shows its first step: at once as a glimpse, and as a moment when all of it was read.
  /// @param attempt uuid that the recording must have; empty: any
  ReplayPlayer(std::filesystem::path file, std::string attempt, Receiver receiver);
  /// Waits for the step that is being computed.
  ~ReplayPlayer();

  /// Any thread; returns at once. What is asked for before the file is open is done then. A newer wish replaces one
  /// that is not reached yet.
  void ask(const ReplayWish& wish);

 private:
  class Run;
  /// The wishes so far.
  struct Asked {
    std::optional<double> time;
    int steps = 0;
    bool playing = false;
    double speed = 1.0;
    bool stop = false;
    std::uint64_t number = 0;  ///< of changes so far
  };
  void run();

  std::filesystem::path file_;
  std::string attempt_;
  Receiver receiver_;
  std::mutex mutex_;
  std::condition_variable wake_;
  Asked wish_;
  std::thread thread_;  // last: it uses what is above
};

/// State of a replay and its possible controls.
struct ReplayReach {
  std::optional<std::uint64_t> step;         ///< the last step done; none before the first
  std::span<const std::uint64_t> keyframes;  ///< steps after which there is a keyframe, rising
  std::uint64_t budget = 1;                  ///< steps that may be re-simulated before the next picture
};

struct ReplayMove {
  std::uint64_t step = 0;  ///< to be shown next
  bool hops = false;       ///< re-simulation cannot keep pace: steps between were left out, by a keyframe
};

/// While playing. The picture that is due, if the budget leads there from here or from a keyframe; else the last
/// keyframe before it; else as far as the budget leads.
/// @param due step that the clock asks for
ReplayMove playTowards(const ReplayReach& reach, std::uint64_t due);

/// Steps to be re-simulated to stand at `step`: from here, or from the nearest keyframe, whichever is less.
std::uint64_t stepsTo(const ReplayReach& reach, std::uint64_t step);

/// On the way to a moment that was asked for: the nearest keyframe where that is better than going on from here, then
/// forward by the budget.
std::uint64_t seekTowards(const ReplayReach& reach, std::uint64_t target);

/// A stretch of one phase; phases may recur.
struct TrackPhase {
  Phase phase = Phase::none;
  double begin = 0.0, end = 0.0;  ///< s
};

/// An event or an error that has words (Told in event_words.h).
struct TrackEvent {
  double time = 0.0;                      ///< end of its step (s)
  std::string title;                      ///< Told::title
  std::string text;                       ///< "cystic duct: clip set (right hand)"
  bool error = false;                     ///< Told::marked()
  std::optional<Severity> severity = {};  ///< of an error
};

/// One hand's values over bins of equal length.
struct HandTrace {
  std::vector<double> force;  ///< largest force on the hand within the bin (N)
  std::vector<double> speed;  ///< way of the real tip within the bin, filtered as figures are, over its length (m/s)
};

struct AttemptTrack {
  std::string attempt, parent;  ///< uuids; parent empty unless it is a branch
  double forkTime = 0.0;        ///< end of the last step that a branch shares with its parent (s)
  double seconds = 0.0;
  double bin = 0.0;  ///< length of a trace's bin (s); the last one may be shorter
  std::array<HandTrace, handCount> hand;
  std::vector<TrackPhase> phases;
  std::vector<TrackEvent> events;
  std::vector<analytics::ErrorLine> errors;  ///< the gravest first
  std::string none;                          ///< why there are no phases, events and traces, or empty
};

inline constexpr std::uint64_t maxBins = 1500;  ///< of a trace: more than a screen has columns for it

/// Reads the whole recording. @param progress steps done, of all; may throw to break off
/// @throws Error (damaged)
AttemptTrack readTrack(recorder::Recording& recording,
                       const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});

}  // namespace calot::gui
