// SPDX-License-Identifier: GPL-3.0-or-later
// Forces by structure: what each organ, vessel and body of fat had to bear, pressed or held.
#include "analytics/checkpoints/checkpoint.h"

#include <algorithm>

#include "analytics/checkpoints/force.h"
#include "analytics/statistics/descriptive.h"

namespace calot::analytics {
namespace {

const CheckpointDefinition& p99Definition() {
  static const CheckpointDefinition d{
      .name = "structure-force-p99",
      .title = "99th percentile of the force on the organ",
      .unit = "N",
      .displayUnit = "N",
      .displayFactor = 1.0,
      .direction = Direction::lower,
      .window = "whole attempt",
      .aggregation = Aggregation::organ,
      .instruments = "sum over instruments in each step",
      .filter = "steps of at least 0.01 N",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 1,
      .definition =
          "quantile of type 7 at 0.99 of F(o) over the steps with F(o) >= 0.01 N; F(o) = sum over instruments of the "
          "magnitudes of its normal forces on organ o, and of the pull on it where its jaws hold it",
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
      .definition = "step length * sum over steps of F(o), F as in structure-force-p99",
      .paperReading = "",
  };
  return d;
}

class StructureForce final : public Checkpoint {
 public:
  StructureForce(const AttemptContext& context, bool impulse)
      : definition_(impulse ? impulseDefinition() : p99Definition()),
        stepSeconds_(context.ticksPerStep * context.tickSeconds),
        structures_(context.structures),
        impulse_(impulse),
        tooOld_(whyTooOld(context, 2)),
        force_(context.structures.size()),
        sum_(context.structures.size(), 0.0) {}

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    if (!tooOld_.empty()) return;
    for (std::size_t s = 0; s < sum_.size(); ++s) {
      double force = 0.0;
      for (const HandResult& hand : record.result.hand) {
        if (s < hand.structureForce.size()) force += hand.forceOn(s);
      }
      sum_[s] += force * stepSeconds_;
      if (!impulse_ && force >= leastForce) force_[s].push_back(force);
    }
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    std::vector<CheckpointValue> result;
    for (std::size_t s = 0; s < sum_.size(); ++s) {
      if (!tooOld_.empty()) {
        result.push_back(makeMissing(definition_, structures_[s], end.origin, Availability::notApplicable, tooOld_));
      } else if (impulse_) {
        result.push_back(makeValue(definition_, structures_[s], end.origin, sum_[s]));
      } else if (force_[s].empty()) {
        result.push_back(makeMissing(definition_, structures_[s], end.origin, Availability::notApplicable,
                                     "nothing touched it with 0.01 N"));
      } else {
        std::vector<double> sorted = force_[s];
        std::sort(sorted.begin(), sorted.end());
        result.push_back(makeValue(definition_, structures_[s], end.origin, quantileOfSorted(sorted, 0.99)));
      }
    }
    return result;
  }

 private:
  const CheckpointDefinition& definition_;
  double stepSeconds_;
  std::vector<std::string> structures_;
  bool impulse_;
  std::string tooOld_;
  std::vector<std::vector<double>> force_;  ///< per structure: of steps in which something touched it (N)
  std::vector<double> sum_;                 ///< N s
};

}  // namespace

std::vector<CheckpointEntry> structureForceEntries() {
  return {{{CheckpointFamily::contact, 44},
           p99Definition(),
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
