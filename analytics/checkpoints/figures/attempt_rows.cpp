// SPDX-License-Identifier: GPL-3.0-or-later
// How long the attempt and its phases lasted, and how exact its simulation was.
#include <fmt/format.h>

#include <array>

#include "analytics/checkpoints/figures/rows.h"
#include "analytics/checkpoints/phases.h"
#include "analytics/checkpoints/replay_words.h"
#include "recorder/replay.h"

namespace calot::analytics {
namespace {

/// An attempt that was not completed has no time: abandoning is not being fast.
struct ElapsedTime {
  const AttemptContext& context;

  [[nodiscard]] Measured figure(const AttemptEnd& end) const {
    const double seconds = context.seconds(end.steps);
    const auto missing = [&](Availability availability, const char* what) {
      return Measured::none(availability, fmt::format("{} at {:.3f} s", what, seconds));
    };
    switch (end.outcome) {
      case recorder::Outcome::completed:
        return Measured::of(seconds, stretchNote(end));
      case recorder::Outcome::timeLimit:
        return missing(Availability::notAvailable, "not completed: time limit reached");
      case recorder::Outcome::abandoned:
        return missing(Availability::notApplicable, "not completed: abandoned");
      case recorder::Outcome::stopped:
        return missing(Availability::notApplicable, "not completed: stopped");
      case recorder::Outcome::technicalFailure:
        return missing(Availability::notAvailable, "not completed: technical failure");
      case recorder::Outcome::running:
        break;
    }
    return missing(Availability::notAvailable, "not completed: the recording ends");
  }
};

struct AttemptDuration {
  const AttemptContext& context;

  [[nodiscard]] Measured figure(const AttemptEnd& end) const {
    return Measured::of(context.seconds(end.steps), stretchNote(end));
  }
};

struct PhaseDuration {
  const AttemptContext& context;
  std::array<std::uint64_t, windowPhases.size()> steps{};

  void add(const recorder::StepRecord& /*record*/, const Judgement& judgement) {
    const std::size_t window = windowOf(judgement.phase);
    if (window < steps.size()) ++steps[window];
  }
  [[nodiscard]] Measured figure(const AttemptEnd& end, std::size_t window) const {
    return Measured::of(context.seconds(steps[window]), stretchNote(end));
  }
};

struct StepsMissed {
  recorder::StepMisses misses;

  void add(const StepResult& result) { misses.add(result.misses); }
  [[nodiscard]] Measured figure() const {
    if (misses.steps == 0) return Measured::notAvailable("no step was done");
    return Measured::of(static_cast<double>(misses.any) / static_cast<double>(misses.steps), wordsFor(misses));
  }
};

}  // namespace

std::vector<CheckpointEntry> attemptRows() {
  const std::vector<Origin> anyOrigin{Origin::resimulated, Origin::observables, Origin::samples};
  return {
      {.place = {CheckpointFamily::paper, 10, "elapsed"},
       .definition = {.name = "elapsed-time",
                      .title = "Elapsed time to completion",
                      .unit = "s",
                      .direction = Direction::lower,
                      .window = "whole attempt, completed ones only",
                      .instruments = "none",
                      .origins = anyOrigin,
                      .finality = Finality::final,
                      .definition = "T = steps * ticks per step * tick length, when the outcome is completed",
                      .paperReading = "Elapsed time (s): simulated time from the first step to the completing one"},
       .accumulate = accumulating<ElapsedTime>()},
      {.place = {CheckpointFamily::motion, 10, "duration"},
       .definition = {.name = "attempt-duration",
                      .title = "Duration of the attempt",
                      .unit = "s",
                      .window = "whole attempt, whatever its outcome",
                      .instruments = "none",
                      .origins = anyOrigin,
                      .definition = "D = steps * ticks per step * tick length",
                      .notOutcome = "it repeats the elapsed time"},
       .accumulate = accumulating<AttemptDuration>()},
      {.place = {CheckpointFamily::phases, 10},
       .definition = {.name = "phase-duration",
                      .title = "Duration of the phase",
                      .unit = "s",
                      .window = "each phase of the procedure, as often as it recurs",
                      .aggregation = Aggregation::phase,
                      .instruments = "none",
                      .version = judgedVersion(1),
                      .definition = "steps in the phase * ticks per step * tick length"},
       .needs = {hasProcedure},
       .results = 3,
       .accumulate = accumulating<PhaseDuration>(),
       .ofAbsentPhases = true},
      {.place = {CheckpointFamily::exactness, 10},
       .definition = {.name = "steps-missed",
                      .title = "Steps that missed a tolerance",
                      .unit = "1",
                      .displayUnit = "%",
                      .definition = "#{steps whose linear solve or contact problem was left above its tolerance, or "
                                    "that held tissue back} / #{steps}",
                      .notOutcome = "it describes the simulation"},
       .accumulate = accumulating<StepsMissed>()},
  };
}

}  // namespace calot::analytics
