// SPDX-License-Identifier: GPL-3.0-or-later
// Tissue held in jaws: for how long, and how hard it was squeezed.
#include "analytics/checkpoints/checkpoint.h"

#include <utility>

namespace calot::analytics {
namespace {

const CheckpointDefinition& timeHeldDefinition() {
  static const CheckpointDefinition d{
      .name = "time-held",
      .title = "Time that jaws held the organ",
      .unit = "s",
      .displayUnit = "s",
      .displayFactor = 1.0,
      .direction = Direction::none,
      .window = "whole attempt",
      .aggregation = Aggregation::organ,
      .instruments = "sum over instruments: two at once count twice",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 1,
      .definition = "H(o) = step length * sum over instruments #{steps at whose end its jaws hold organ o}",
      .paperReading = "",
  };
  return d;
}

const CheckpointDefinition& crushDoseDefinition() {
  static const CheckpointDefinition d{
      .name = "crush-dose",
      .title = "Crush dose of the organ",
      .unit = "N s",
      .displayUnit = "N s",
      .displayFactor = 1.0,
      .direction = Direction::lower,
      .window = "whole attempt",
      .aggregation = Aggregation::organ,
      .instruments = "sum over instruments",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 1,
      .definition =
          "D(o) = step length * sum over instruments and steps of the grip force, while its jaws hold organ o",
      .paperReading = "",
  };
  return d;
}

class Holding final : public Checkpoint {
 public:
  Holding(const AttemptContext& context, bool dose)
      : definition_(dose ? crushDoseDefinition() : timeHeldDefinition()),
        stepSeconds_(context.ticksPerStep * context.tickSeconds),
        structures_(context.structures),
        dose_(dose),
        tooOld_(whyTooOld(context, dose ? 5 : 2)),
        sum_(context.structures.size(), 0.0) {}

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    for (const HandResult& hand : record.result.hand) {
      for (std::size_t s = 0; s < sum_.size(); ++s) {
        if ((hand.grasping >> s & 1U) != 0) sum_[s] += dose_ ? hand.gripForce : 1.0;
      }
    }
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    std::vector<CheckpointValue> result;
    for (std::size_t s = 0; s < sum_.size(); ++s) {
      result.push_back(
          tooOld_.empty() ? makeValue(definition_, structures_[s], end.origin, sum_[s] * stepSeconds_, stretchNote(end))
                          : makeMissing(definition_, structures_[s], end.origin, Availability::notApplicable, tooOld_));
    }
    return result;
  }

 private:
  const CheckpointDefinition& definition_;
  double stepSeconds_;
  std::vector<std::string> structures_;
  bool dose_;
  std::string tooOld_;
  std::vector<double> sum_;
};

}  // namespace

std::vector<CheckpointEntry> holdingEntries() {
  return {{{CheckpointFamily::contact, 23},
           timeHeldDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<Holding>(context, false);
           }},
          {{CheckpointFamily::contact, 26},
           crushDoseDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<Holding>(context, true);
           }}};
}

}  // namespace calot::analytics
