// SPDX-License-Identifier: GPL-3.0-or-later
// Forces by structure: what each organ, vessel and body of fat had to bear, pressed or held.
#include "analytics/checkpoints/checkpoint.h"

#include <algorithm>

namespace calot::analytics {
namespace {

const CheckpointDefinition& maximumDefinition() {
  static const CheckpointDefinition d{
      .name = "structure-force-maximum",
      .title = "Largest force on the organ",
      .unit = "N",
      .displayUnit = "N",
      .displayFactor = 1.0,
      .direction = Direction::lower,
      .window = "whole attempt",
      .aggregation = Aggregation::organ,
      .instruments = "sum over instruments in each step",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 1,
      .definition =
          "max over steps of F(o); F(o) = sum over instruments of the magnitudes of its normal forces on organ o, and "
          "of "
          "the pull on it where its jaws hold it",
      .paperReading = "",
  };
  return d;
}

const CheckpointDefinition& impulseDefinition() {
  static const CheckpointDefinition d{
      .name = "structure-force-impulse",
      .title = "Impulse on the organ",
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
      .definition = "step length * sum over steps of F(o), F as in structure-force-maximum",
      .paperReading = "",
  };
  return d;
}

class StructureForce final : public Checkpoint {
 public:
  StructureForce(const AttemptContext& context, bool impulse)
      : definition_(impulse ? impulseDefinition() : maximumDefinition()),
        stepSeconds_(context.ticksPerStep * context.tickSeconds),
        structures_(context.structures),
        impulse_(impulse),
        tooOld_(whyTooOld(context, 2)),
        value_(context.structures.size(), 0.0) {}

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    if (!tooOld_.empty()) return;
    for (std::size_t s = 0; s < value_.size(); ++s) {
      double force = 0.0;
      for (const HandResult& hand : record.result.hand) {
        if (s < hand.structureForce.size()) force += hand.forceOn(s);
      }
      value_[s] = impulse_ ? value_[s] + force * stepSeconds_ : std::max(value_[s], force);
    }
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    std::vector<CheckpointValue> result;
    for (std::size_t s = 0; s < value_.size(); ++s) {
      result.push_back(
          tooOld_.empty() ? makeValue(definition_, structures_[s], end.origin, value_[s])
                          : makeMissing(definition_, structures_[s], end.origin, Availability::notApplicable, tooOld_));
    }
    return result;
  }

 private:
  const CheckpointDefinition& definition_;
  double stepSeconds_;
  std::vector<std::string> structures_;
  bool impulse_;
  std::string tooOld_;
  std::vector<double> value_;
};

}  // namespace

std::vector<CheckpointEntry> structureForceEntries() {
  return {{{CheckpointFamily::contact, 44},
           maximumDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<StructureForce>(context, false);
           }},
          {{CheckpointFamily::contact, 47},
           impulseDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<StructureForce>(context, true);
           }}};
}

}  // namespace calot::analytics
