// SPDX-License-Identifier: GPL-3.0-or-later
// How long the attempt lasted, whatever its outcome: what other figures are held against.
#include "analytics/checkpoints/checkpoint.h"

namespace calot::analytics {
namespace {

const CheckpointDefinition& attemptDurationDefinition() {
  static const CheckpointDefinition d{
      .name = "attempt-duration",
      .title = "Duration of the attempt",
      .unit = "s",
      .displayUnit = "s",
      .displayFactor = 1.0,
      .direction = Direction::none,
      .window = "whole attempt, whatever its outcome",
      .aggregation = Aggregation::attempt,
      .instruments = "none",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables, Origin::samples},
      .finality = Finality::running,
      .version = 1,
      .definition = "D = steps * ticks per step * tick length",
      .paperReading = "",
      .notOutcome = "it repeats the elapsed time",
  };
  return d;
}

class AttemptDuration final : public Checkpoint {
 public:
  explicit AttemptDuration(const AttemptContext& context)
      : tickSeconds_(context.tickSeconds), ticksPerStep_(context.ticksPerStep) {}

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    return {makeValue(attemptDurationDefinition(), "", end.origin,
                      static_cast<double>(end.steps * ticksPerStep_) * tickSeconds_, stretchNote(end))};
  }

 private:
  double tickSeconds_;
  std::uint64_t ticksPerStep_;
};

}  // namespace

std::vector<CheckpointEntry> attemptDurationEntries() {
  return {{{CheckpointFamily::motion, 10, "duration"},
           attemptDurationDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<AttemptDuration>(context);
           }}};
}

}  // namespace calot::analytics
