// SPDX-License-Identifier: GPL-3.0-or-later
// How often the simulation was not as exact as its scene asks for: what the other figures must be read with.
#include "analytics/checkpoints/checkpoint.h"
#include "recorder/step_watch.h"

namespace calot::analytics {
namespace {

const CheckpointDefinition& stepsMissedDefinition() {
  static const CheckpointDefinition d{
      .name = "steps-missed",
      .title = "Steps that missed a tolerance",
      .unit = "1",
      .displayUnit = "%",
      .displayFactor = 100.0,
      .direction = Direction::none,
      .window = "whole attempt",
      .aggregation = Aggregation::attempt,
      .instruments = "union over instruments",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 1,
      .definition =
          "#{steps whose linear solve or contact problem was left above its tolerance, or that held tissue back} / "
          "#{steps}",
      .paperReading = "",
      .notOutcome = "it describes the simulation",
  };
  return d;
}

class StepsMissed final : public Checkpoint {
 public:
  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    misses_.add(record.result.misses);
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    if (misses_.steps == 0) {
      return {makeMissing(stepsMissedDefinition(), "", end.origin, Availability::notAvailable, "no step was done")};
    }
    return {makeValue(stepsMissedDefinition(), "", end.origin,
                      static_cast<double>(misses_.any) / static_cast<double>(misses_.steps), describe(misses_))};
  }

 private:
  recorder::StepMisses misses_;
};

}  // namespace

std::vector<CheckpointEntry> stepsMissedEntries() {
  return {{{CheckpointFamily::exactness, 10},
           stepsMissedDefinition(),
           [](const AttemptContext&) -> std::unique_ptr<Checkpoint> { return std::make_unique<StepsMissed>(); }}};
}

}  // namespace calot::analytics
