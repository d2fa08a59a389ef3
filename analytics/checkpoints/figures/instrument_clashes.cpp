// SPDX-License-Identifier: GPL-3.0-or-later
// How often, and for how long, one instrument touched the other.
#include "analytics/checkpoints/checkpoint.h"

namespace calot::analytics {
namespace {

const CheckpointDefinition& clashesDefinition() {
  static const CheckpointDefinition d{
      .name = "instrument-clashes",
      .title = "Times that the instruments touched each other",
      .unit = "1",
      .displayUnit = "1",
      .displayFactor = 1.0,
      .direction = Direction::lower,
      .window = "whole attempt",
      .aggregation = Aggregation::attempt,
      .instruments = "both together",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 1,
      .definition = "#{touches of both instruments}; contact that is interrupted for less than 0.1 s is one touch",
      .paperReading = "",
  };
  return d;
}

const CheckpointDefinition& clashTimeDefinition() {
  static const CheckpointDefinition d{
      .name = "instrument-clash-time",
      .title = "Time that the instruments touched each other",
      .unit = "s",
      .displayUnit = "s",
      .displayFactor = 1.0,
      .direction = Direction::lower,
      .window = "whole attempt",
      .aggregation = Aggregation::attempt,
      .instruments = "both together",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 1,
      .definition = "step length * #{steps in which the instruments exert a force on each other}",
      .paperReading = "",
  };
  return d;
}

class InstrumentClashes final : public Checkpoint {
 public:
  InstrumentClashes(const AttemptContext& context, bool time)
      : definition_(time ? clashTimeDefinition() : clashesDefinition()),
        notApplicable_(whyTooOld(context, 6)),
        stepSeconds_(context.tickSeconds * static_cast<double>(context.ticksPerStep)),
        time_(time) {}

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    const StepResult& result = record.result;
    two_ = two_ ||
           (result.hand[0].instrument != InstrumentKind::none && result.hand[1].instrument != InstrumentKind::none);
    steps_ += result.contact.instrumentsTouch ? 1 : 0;
    for (const Event& event : result.events) touches_ += event.kind == EventKind::instrumentsTouched ? 1 : 0;
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    const std::string why = !notApplicable_.empty() ? notApplicable_ : two_ ? "" : "there were never two instruments";
    if (!why.empty()) return {makeMissing(definition_, "", end.origin, Availability::notApplicable, why)};
    const double value = time_ ? stepSeconds_ * static_cast<double>(steps_) : static_cast<double>(touches_);
    return {makeValue(definition_, "", end.origin, value, time_ ? stretchNote(end) : std::string())};
  }

 private:
  const CheckpointDefinition& definition_;
  std::string notApplicable_;
  double stepSeconds_;
  bool time_;
  bool two_ = false;
  std::uint64_t touches_ = 0, steps_ = 0;
};

}  // namespace

std::vector<CheckpointEntry> instrumentClashesEntries() {
  return {{{CheckpointFamily::contact, 41},
           clashesDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<InstrumentClashes>(context, false);
           }},
          {{CheckpointFamily::contact, 42},
           clashTimeDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<InstrumentClashes>(context, true);
           }}};
}

}  // namespace calot::analytics
