// SPDX-License-Identifier: GPL-3.0-or-later
// How long each phase of the procedure lasted.
#include "analytics/checkpoints/checkpoint.h"

#include <array>

#include "analytics/checkpoints/phases.h"

namespace calot::analytics {
namespace {

const CheckpointDefinition& phaseDurationDefinition() {
  static const CheckpointDefinition d{
      .name = "phase-duration",
      .title = "Duration of the phase",
      .unit = "s",
      .displayUnit = "s",
      .displayFactor = 1.0,
      .direction = Direction::none,
      .window = "each phase of the procedure, as often as it recurs",
      .aggregation = Aggregation::phase,
      .instruments = "none",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = judgedVersion(1),
      .definition = "steps in the phase * ticks per step * tick length",
      .paperReading = "",
  };
  return d;
}

class PhaseDuration final : public Checkpoint {
 public:
  explicit PhaseDuration(const AttemptContext& context)
      : notApplicable_(whyNoPhases(context)), tickSeconds_(context.tickSeconds), ticksPerStep_(context.ticksPerStep) {}

  void onStep(const recorder::StepRecord& /*record*/, const Judgement& judgement) override {
    for (std::size_t i = 0; i < windowPhases.size(); ++i) steps_[i] += judgement.phase == windowPhases[i] ? 1 : 0;
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    if (!notApplicable_.empty())
      return {makeMissing(phaseDurationDefinition(), "", end.origin, Availability::notApplicable, notApplicable_)};
    std::vector<CheckpointValue> result;
    for (std::size_t i = 0; i < windowPhases.size(); ++i) {
      result.push_back(makeValue(phaseDurationDefinition(), nameOf(windowPhases[i]), end.origin,
                                 static_cast<double>(steps_[i] * ticksPerStep_) * tickSeconds_, stretchNote(end)));
    }
    return result;
  }

 private:
  std::string notApplicable_;
  double tickSeconds_;
  std::uint64_t ticksPerStep_;
  std::array<std::uint64_t, windowPhases.size()> steps_{};
};

}  // namespace

std::vector<CheckpointEntry> phaseDurationEntries() {
  return {{{CheckpointFamily::phases, 10},
           phaseDurationDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<PhaseDuration>(context);
           }}};
}

}  // namespace calot::analytics
