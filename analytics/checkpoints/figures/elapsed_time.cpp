// SPDX-License-Identifier: GPL-3.0-or-later
// Time to completion. An attempt that was not completed has none: abandoning is not being fast.
#include "analytics/checkpoints/checkpoint.h"

#include <fmt/format.h>

namespace calot::analytics {
namespace {

const CheckpointDefinition& elapsedTimeDefinition() {
  static const CheckpointDefinition d{
      .name = "elapsed-time",
      .title = "Elapsed time to completion",
      .unit = "s",
      .displayUnit = "s",
      .displayFactor = 1.0,
      .direction = Direction::lower,
      .window = "whole attempt, completed ones only",
      .aggregation = Aggregation::attempt,
      .instruments = "none",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables, Origin::samples},
      .finality = Finality::final,
      .version = 1,
      .definition = "T = steps * ticks per step * tick length, when the outcome is completed",
      .paperReading = "Elapsed time (s): simulated time from the first step to the completing one",
  };
  return d;
}

class ElapsedTime final : public Checkpoint {
 public:
  explicit ElapsedTime(const AttemptContext& context)
      : tickSeconds_(context.tickSeconds), ticksPerStep_(context.ticksPerStep) {}

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    const double seconds = static_cast<double>(end.steps * ticksPerStep_) * tickSeconds_;
    const auto missing = [&](Availability availability, const char* what) {
      return makeMissing(elapsedTimeDefinition(), "", end.origin, availability,
                         fmt::format("{} at {:.3f} s", what, seconds));
    };
    switch (end.outcome) {
      case recorder::Outcome::completed:
        return {makeValue(elapsedTimeDefinition(), "", end.origin, seconds, stretchNote(end))};
      case recorder::Outcome::timeLimit:
        return {missing(Availability::notAvailable, "not completed: time limit reached")};
      case recorder::Outcome::abandoned:
        return {missing(Availability::notApplicable, "not completed: abandoned")};
      case recorder::Outcome::stopped:
        return {missing(Availability::notApplicable, "not completed: stopped")};
      case recorder::Outcome::technicalFailure:
        return {missing(Availability::notAvailable, "not completed: technical failure")};
      case recorder::Outcome::running:
        break;
    }
    return {missing(Availability::notAvailable, "not completed: the recording ends")};
  }

 private:
  double tickSeconds_;
  std::uint64_t ticksPerStep_;
};

}  // namespace

std::vector<CheckpointEntry> elapsedTimeEntries() {
  return {{{CheckpointFamily::paper, 10, "elapsed"},
           elapsedTimeDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<ElapsedTime>(context);
           }}};
}

}  // namespace calot::analytics
