// SPDX-License-Identifier: GPL-3.0-or-later
// Contact time per organ, in both readings: the paper's duct time exceeds its task time, so it can't be a union.
#include "analytics/checkpoints/checkpoint.h"

#include <algorithm>

namespace calot::analytics {
namespace {

const CheckpointDefinition& contactUnionDefinition() {
  static const CheckpointDefinition d{
      .name = "contact-time-union",
      .title = "Contact time with the organ (any instrument)",
      .unit = "s",
      .displayUnit = "s",
      .displayFactor = 1.0,
      .direction = Direction::none,
      .window = "whole attempt",
      .aggregation = Aggregation::organ,
      .instruments = "union over instruments: two at once count once",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 2,
      .definition =
          "C_union(o) = step length * #{steps at whose end any instrument exerts a force on organ o or holds it}",
      .paperReading = "",
  };
  return d;
}

const CheckpointDefinition& contactSumDefinition() {
  static const CheckpointDefinition d{
      .name = "contact-time-sum",
      .title = "Contact time with the organ (summed over instruments)",
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
      .version = 2,
      .definition =
          "C_sum(o) = step length * sum over instruments #{steps at whose end it exerts a force on organ o or holds "
          "it}",
      .paperReading = "",
  };
  return d;
}

class ContactTime final : public Checkpoint {
 public:
  ContactTime(const AttemptContext& context, bool sum)
      : tickSeconds_(context.tickSeconds),
        ticksPerStep_(context.ticksPerStep),
        organs_(context.structures),
        sum_(sum),
        steps_(context.structures.size(), 0) {}

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    for (std::size_t o = 0; o < steps_.size(); ++o) {
      std::uint64_t touching = 0;
      for (const HandResult& hand : record.result.hand) touching += hand.contacts() >> o & 1U;
      steps_[o] += sum_ ? touching : std::min<std::uint64_t>(touching, 1);
    }
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    const CheckpointDefinition& d = sum_ ? contactSumDefinition() : contactUnionDefinition();
    std::vector<CheckpointValue> result;
    for (std::size_t o = 0; o < organs_.size(); ++o) {
      result.push_back(makeValue(d, organs_[o], end.origin,
                                 static_cast<double>(steps_[o] * ticksPerStep_) * tickSeconds_, stretchNote(end)));
    }
    return result;
  }

 private:
  double tickSeconds_;
  std::uint64_t ticksPerStep_;
  std::vector<std::string> organs_;
  bool sum_;
  std::vector<std::uint64_t> steps_;
};

}  // namespace

std::vector<CheckpointEntry> contactTimeEntries() {
  return {{{CheckpointFamily::contact, 10},
           contactUnionDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<ContactTime>(context, false);
           }},
          {{CheckpointFamily::contact, 20},
           contactSumDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<ContactTime>(context, true);
           }}};
}

}  // namespace calot::analytics
