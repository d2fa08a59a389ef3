// SPDX-License-Identifier: GPL-3.0-or-later
// Heat on the walls of vessels that must be spared: it injures long before it opens them.
#include "analytics/checkpoints/checkpoint.h"

#include <fmt/format.h>

namespace calot::analytics {
namespace {

const CheckpointDefinition& thermalInjuryDefinition() {
  static const CheckpointDefinition d{
      .name = "thermal-injury",
      .title = "Spared vessels' walls injured by heat",
      .unit = "m",
      .displayUnit = "mm",
      .displayFactor = 1000.0,
      .direction = Direction::lower,
      .window = "whole attempt",
      .aggregation = Aggregation::attempt,
      .instruments = "union over instruments",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 1,
      .definition =
          "sum over the vessels that the scene's procedure tells to spare of the length of wall whose cautery reached "
          "the scene's share `injury` of what parts it",
      .paperReading = "",
  };
  return d;
}

class ThermalInjury final : public Checkpoint {
 public:
  explicit ThermalInjury(const AttemptContext& context) : vessel_(context.scene.vessel), injured_(vessel_.size(), 0.0) {
    bool any = false;
    for (const SceneFacts::Vessel& vessel : vessel_) any = any || vessel.spared;
    notApplicable_ = !context.procedure ? "the scene has no procedure"
                     : !any             ? "the scene's procedure names no vessel to be spared"
                                        : whyTooOld(context, 5);
  }

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    if (!notApplicable_.empty()) return;
    for (std::size_t v = 0; v < vessel_.size(); ++v) injured_[v] = record.result.vessel[v].injured;
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    const CheckpointDefinition& d = thermalInjuryDefinition();
    if (!notApplicable_.empty()) return {makeMissing(d, "", end.origin, Availability::notApplicable, notApplicable_)};
    double sum = 0.0;
    std::string note;
    for (std::size_t v = 0; v < vessel_.size(); ++v) {
      if (vessel_[v].spared) sum += injured_[v];
      if (injured_[v] > 0.0)
        note += fmt::format("{}{} {:.2f} mm", note.empty() ? "" : ", ", vessel_[v].name, 1000.0 * injured_[v]);
    }
    return {makeValue(d, "", end.origin, sum, std::move(note))};
  }

 private:
  std::vector<SceneFacts::Vessel> vessel_;
  std::vector<double> injured_;  ///< m
  std::string notApplicable_;
};

}  // namespace

std::vector<CheckpointEntry> thermalInjuryEntries() {
  return {{{CheckpointFamily::safety, 45},
           thermalInjuryDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<ThermalInjury>(context);
           }}};
}

}  // namespace calot::analytics
