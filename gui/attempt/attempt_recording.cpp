// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/attempt_recording.h"

#include <fmt/format.h>
#include <algorithm>

#include "gui/words/event_words.h"
#include "recorder/base/errors.h"
#include "recorder/kept/engine_folders.h"
#include "recorder/recorded_results.h"
#include "sim/scene/version.h"

namespace calot::gui {
namespace {

std::string withHand(std::string text, const Event& event) {
  if (event.hand < handCount) text += fmt::format(" ({} hand)", handNames[event.hand]);
  return text;
}

/// Largest force and the way of each hand, bin by bin.
class Tracer {
 public:
  Tracer(AttemptTrack& track, std::uint64_t stepsPerBin, double stepSeconds)
      : track_(track), stepsPerBin_(stepsPerBin), stepSeconds_(stepSeconds) {}

  void add(const recorder::RecordedStep& step) {
    for (std::size_t h = 0; h < handCount; ++h) {
      for (const recorder::TickOutcome& tick : step.ticks) force_[h] = std::max(force_[h], tick.hand[h].force.norm());
      const Vec3& tip = step.result.hand[h].tipReal;
      const InstrumentKind now = step.result.hand[h].instrument;
      // Another instrument, or one that was not there, is no movement.
      if (any_ && now != InstrumentKind::none && now == instrument_[h]) way_[h] += (tip - tip_[h]).norm();
      tip_[h] = tip;
      instrument_[h] = now;
    }
    any_ = true;
    if (++steps_ == stepsPerBin_) finishBin();
  }
  void finishBin() {
    if (steps_ == 0) return;
    for (std::size_t h = 0; h < handCount; ++h) {
      track_.hand[h].force.push_back(force_[h]);
      track_.hand[h].speed.push_back(way_[h] / (static_cast<double>(steps_) * stepSeconds_));
    }
    force_.fill(0.0);
    way_.fill(0.0);
    steps_ = 0;
  }

 private:
  AttemptTrack& track_;
  std::uint64_t stepsPerBin_, steps_ = 0;
  double stepSeconds_;
  bool any_ = false;
  std::array<double, handCount> force_{}, way_{};
  std::array<Vec3, handCount> tip_{Vec3::Zero(), Vec3::Zero()};
  std::array<InstrumentKind, handCount> instrument_{};
};

}  // namespace

AttemptTrack readTrack(recorder::Recording& recording,
                       const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  AttemptTrack track;
  track.seconds = recording.seconds();
  const recorder::AttemptHeader& header = recording.header();
  if (header.purpose == "golden") {
    track.none =
        "A golden recording holds no results of its steps: there is no timeline. The replay shows it all the same.";
    return track;
  }
  const std::uint64_t steps = recording.stepCount();
  const double stepSeconds = header.tickSeconds * static_cast<double>(header.ticksPerStep);
  const std::uint64_t stepsPerBin = std::max<std::uint64_t>(1, (steps + maxBins - 1) / maxBins);
  track.bin = static_cast<double>(stepsPerBin) * stepSeconds;
  const SubjectNames names{header.structures(), {}};
  recorder::RecordedJudge judge(header);
  Tracer tracer(track, stepsPerBin, stepSeconds);
  for (std::uint64_t n = 0; n < steps; ++n) {
    const recorder::RecordedStep& step = recording.step(n);
    const double end = static_cast<double>(n + 1) * stepSeconds;
    tracer.add(step);
    const Judgement& judgement = judge.observe(step);
    const Phase phase = judgement.phase;
    if (track.phases.empty() || track.phases.back().phase != phase)
      track.phases.push_back({phase, static_cast<double>(n) * stepSeconds, end});
    track.phases.back().end = end;
    for (const Event& event : judgement.events) {
      const EventWords* const words = wordsOf(event.kind);
      if (words != nullptr)
        track.events.push_back({end, event.kind, withHand(textOf(event, names), event), words->fault});
    }
    if (progress && (n % 100 == 99 || n + 1 == steps)) progress(n + 1, steps);
  }
  tracer.finishBin();
  if (track.phases.size() == 1 && track.phases[0].phase == Phase::none) track.phases.clear();
  return track;
}

namespace fs = std::filesystem;

fs::path findRecording(const analytics::AttemptRow& attempt, const fs::path& database,
                       const std::vector<fs::path>& folders) {
  // The name comes from a database that anyone may have made: it names a file, never a folder.
  const fs::path name = fs::path(attempt.fileName).filename();
  if (name.empty() || name.extension() != ".h5") return {};
  std::vector<fs::path> places{database.parent_path()};
  places.insert(places.end(), folders.begin(), folders.end());
  for (const fs::path& place : places) {
    std::error_code ignored;
    if (fs::is_regular_file(place / name, ignored)) return place / name;
  }
  return {};
}

recorder::Recording openRecording(const fs::path& file, const std::string& attempt) {
  const recorder::ChainVerdict chain = recorder::probe(file);
  recorder::Recording recording(file);
  const std::string name = file.filename().string();
  const std::string& found = recording.header().attempt;
  if (!attempt.empty() && found != attempt)
    throw Error(ErrorKind::refused, Where{name},
                fmt::format("is the recording of attempt {}, not of {}", found, attempt));
  if (!chain.intact)
    throw Error(ErrorKind::refused, Where{name}, fmt::format("its content chain is broken ({})", chain.what));
  if (recording.stepCount() == 0) throw Error(ErrorKind::damaged, Where{name}, "holds no step to show");
  const std::uint32_t version = recording.header().simulationVersion;
  if (version != simulationVersion && recorder::commandOfEngine(version).empty())
    throw Error(ErrorKind::undecided, Where{name},
                fmt::format("was made by simulation version {}; this program has version {}, and no engine of version "
                            "{} is installed to repeat it",
                            version, simulationVersion, version));
  return recording;
}

}  // namespace calot::gui
