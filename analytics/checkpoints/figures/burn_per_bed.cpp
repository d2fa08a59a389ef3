// SPDX-License-Identifier: GPL-3.0-or-later
// Damage for work done: what was charred for each part of the bed that came free.
#include "analytics/checkpoints/checkpoint.h"

#include "analytics/checkpoints/gallbladder_bed.h"
#include "analytics/checkpoints/phase_growth.h"

namespace calot::analytics {
namespace {

/// Share of the bed that is work enough for a ratio.
constexpr double minWork = 0.01;

const CheckpointDefinition& burnPerBedDefinition() {
  static const CheckpointDefinition d{
      .name = "burn-per-bed",
      .title = "Area charred for a whole bed freed",
      .unit = "m^2",
      .displayUnit = "cm^2",
      .displayFactor = 1e4,
      .direction = Direction::lower,
      .window = "whole attempt, those in which at least 1 % of the bed came free only",
      .aggregation = Aggregation::attempt,
      .instruments = "union over instruments: what any of them charred or freed",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 1,
      .definition =
          "charred area of all organs' skins at rest / share of the bed's area that is not attached any more; bed as "
          "in connective-remaining",
      .paperReading = "",
  };
  return d;
}

class BurnPerBed final : public Checkpoint {
 public:
  explicit BurnPerBed(const AttemptContext& context)
      : bed_(context), notApplicable_(bed_.notApplicable().empty() ? whyTooOld(context, 3) : bed_.notApplicable()) {}

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    if (!notApplicable_.empty()) return;
    bed_.take(record.result);
    charred_ = charredArea(record.result);
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    const auto missing = [&](const std::string& why) {
      return makeMissing(burnPerBedDefinition(), "", end.origin, Availability::notApplicable, why);
    };
    if (!notApplicable_.empty()) return {missing(notApplicable_)};
    const double freed = bed_.any() ? 1.0 - bed_.attached() : 0.0;
    if (freed < minWork) return {missing("less than 1 % of the bed came free")};
    return {makeValue(burnPerBedDefinition(), "", end.origin, charred_ / freed)};
  }

 private:
  GallbladderBed bed_;
  std::string notApplicable_;
  double charred_ = 0.0;  ///< m^2
};

}  // namespace

std::vector<CheckpointEntry> burnPerBedEntries() {
  return {{{CheckpointFamily::safety, 50},
           burnPerBedDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<BurnPerBed>(context);
           }}};
}

}  // namespace calot::analytics
