// SPDX-License-Identifier: GPL-3.0-or-later
// Course of a recording over time: phases, events, forces and speeds. Knows no window.
// The recording behind an attempt of a cohort database, which knows its file's name and not its folder.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "gui/words/event_words.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/reader.h"

namespace calot::gui {

/// A stretch of one phase; phases may recur.
struct TrackPhase {
  Phase phase = Phase::none;
  double begin = 0.0, end = 0.0;  ///< s
};

/// An event that has words (event_words.h).
struct TrackEvent {
  double time = 0.0;  ///< end of its step (s)
  EventKind kind = EventKind::clipSet;
  std::string text;    ///< "cystic duct: clip set (right hand)"
  bool error = false;  ///< EventWords::fault
};

/// One hand's values over bins of equal length.
struct HandTrace {
  std::vector<double> force;  ///< largest force on the hand within the bin (N)
  std::vector<double> speed;  ///< way of the real tip within the bin, over its length (m/s)
};

struct AttemptTrack {
  double seconds = 0.0;
  double bin = 0.0;  ///< length of a trace's bin (s); the last one may be shorter
  std::array<HandTrace, handCount> hand;
  std::vector<TrackPhase> phases;
  std::vector<TrackEvent> events;
  std::string none;  ///< why there are no phases, events and traces, or empty
};

inline constexpr std::uint64_t maxBins = 1500;  ///< of a trace: more than a screen has columns for it

/// Reads the whole recording. @param progress steps done, of all; may throw to break off
/// @throws Error (damaged)
AttemptTrack readTrack(recorder::Recording& recording,
                       const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});

/// The file of this name beside the database, or in one of the folders, in their order; empty where there is none.
std::filesystem::path findRecording(const analytics::AttemptRow& attempt, const std::filesystem::path& database,
                                    const std::vector<std::filesystem::path>& folders);

/// Opens a recording to be shown. A child process reads all of it first, so that a file that breaks the reading library
/// takes no window with it.
/// @param attempt uuid that it must have; empty: any
/// @throws Error as recorder::probe(); (refused) for another attempt's recording or a broken content chain; (damaged)
/// without any step; (undecided) for one of another simulation version, which this program cannot simulate.
recorder::Recording openRecording(const std::filesystem::path& file, const std::string& attempt);

}  // namespace calot::gui
