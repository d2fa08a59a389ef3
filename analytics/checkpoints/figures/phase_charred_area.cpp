// SPDX-License-Identifier: GPL-3.0-or-later
// In which phase the organs were charred.
#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/phase_growth.h"

namespace calot::analytics {
namespace {

const CheckpointDefinition& phaseCharredAreaDefinition() {
  static const CheckpointDefinition d{
      .name = "phase-charred-area",
      .title = "Area charred in the phase",
      .unit = "m^2",
      .displayUnit = "cm^2",
      .displayFactor = 1e4,
      .direction = Direction::lower,
      .window = "each phase of the procedure, as often as it recurs",
      .aggregation = Aggregation::phase,
      .instruments = "union over instruments: what any of them charred",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = judgedVersion(1),
      .definition = "area of all organs' skins at rest that is charred in the steps of the phase",
      .paperReading = "",
  };
  return d;
}

class PhaseCharredArea final : public Checkpoint {
 public:
  explicit PhaseCharredArea(const AttemptContext& context) : notApplicable_(whyNoPhases(context)) {
    for (const Phase phase : windowPhases) charred_.emplace_back(phase);
  }

  void onStep(const recorder::StepRecord& record, const Judgement& judgement) override {
    if (!notApplicable_.empty()) return;
    const double area = charredArea(record.result);
    for (GrowthInPhase& one : charred_) one.add(judgement.phase, area, record.step == 0);
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    if (!notApplicable_.empty())
      return {makeMissing(phaseCharredAreaDefinition(), "", end.origin, Availability::notApplicable, notApplicable_)};
    std::vector<CheckpointValue> result;
    for (std::size_t w = 0; w < windowPhases.size(); ++w) {
      const char* subject = nameOf(windowPhases[w]);
      result.push_back((*end.phases)[w].seconds > 0.0
                           ? makeValue(phaseCharredAreaDefinition(), subject, end.origin, charred_[w].growth())
                           : makeMissing(phaseCharredAreaDefinition(), subject, end.origin, Availability::notApplicable,
                                         noSuchPhase));
    }
    return result;
  }

 private:
  std::string notApplicable_;
  std::vector<GrowthInPhase> charred_;  ///< as windowPhases
};

}  // namespace

std::vector<CheckpointEntry> phaseCharredAreaEntries() {
  return {{{CheckpointFamily::phases, 160},
           phaseCharredAreaDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<PhaseCharredArea>(context);
           }}};
}

}  // namespace calot::analytics
