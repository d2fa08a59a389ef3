// SPDX-License-Identifier: GPL-3.0-or-later
// Errors that fail an attempt whatever its other figures.
#include "analytics/checkpoints/checkpoint.h"

namespace calot::analytics {
namespace {

const CheckpointDefinition& criticalErrorsDefinition() {
  static const CheckpointDefinition d{
      .name = "critical-errors",
      .title = "Critical errors",
      .unit = "1",
      .displayUnit = "1",
      .displayFactor = 1.0,
      .direction = Direction::lower,
      .window = "whole attempt",
      .aggregation = Aggregation::attempt,
      .instruments = "sum over instruments",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = judgedVersion(1),
      .definition =
          "#{clips on, and cuts, burns and tears through, vessels that the scene's procedure tells to spare}; "
          "one fails the attempt",
      .paperReading = "",
  };
  return d;
}

class CriticalErrors final : public Checkpoint {
 public:
  explicit CriticalErrors(const AttemptContext& context)
      : notApplicable_(context.procedure ? whyTooOld(context, 3) : "the scene has no procedure") {}

  void onStep(const recorder::StepRecord& /*record*/, const Judgement& judgement) override {
    errors_ = judgement.criticalErrors;
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    if (!notApplicable_.empty()) {
      return {makeMissing(criticalErrorsDefinition(), "", end.origin, Availability::notApplicable, notApplicable_)};
    }
    return {makeValue(criticalErrorsDefinition(), "", end.origin, static_cast<double>(errors_),
                      errors_ > 0 ? "fails the attempt" : "")};
  }

 private:
  std::string notApplicable_;
  std::uint32_t errors_ = 0;
};

}  // namespace

std::vector<CheckpointEntry> criticalErrorsEntries() {
  return {{{CheckpointFamily::safety, 90},
           criticalErrorsDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<CriticalErrors>(context);
           }}};
}

}  // namespace calot::analytics
