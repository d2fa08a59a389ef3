// SPDX-License-Identifier: GPL-3.0-or-later
// Damage for work done, each kind of work with the char of its own phase: of clearing the fat, and of dissecting the
// bed.
#include "analytics/checkpoints/checkpoint.h"

#include <optional>

#include "analytics/checkpoints/gallbladder_bed.h"
#include "analytics/checkpoints/phase_growth.h"

namespace calot::analytics {
namespace {

/// Share of all the fat, or of the bed, that is work enough for a ratio.
constexpr double leastShare = 0.01;

CheckpointDefinition member(const char* name, const char* title, const char* window, const char* formula) {
  return {
      .name = name,
      .title = title,
      .unit = "1",
      .displayUnit = "1",
      .displayFactor = 1.0,
      .direction = Direction::lower,
      .window = window,
      .aggregation = Aggregation::attempt,
      .instruments = "union over instruments: what any of them charred, took or freed",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = judgedVersion(1),
      .definition = formula,
      .paperReading = "",
  };
}

const CheckpointDefinition& fatDefinition() {
  static const CheckpointDefinition d = [] {
    CheckpointDefinition fat = member(
        "burn-per-fat", "Area charred for the volume of fat removed",
        "the phase of identification, as often as it recurs, where at least 1 % of the fat went in it",
        "area of all organs' skins at rest that is charred in the window / volume of fat at rest that goes in it");
    fat.unit = "1/m";
    fat.displayUnit = "cm^2/ml";
    fat.displayFactor = 0.01;
    return fat;
  }();
  return d;
}

const CheckpointDefinition& bedDefinition() {
  static const CheckpointDefinition d = member(
      "burn-per-dissection", "Area charred for the area of connective tissue dissected",
      "the phase of dissection, as often as it recurs, where at least 1 % of the bed came free in it",
      "area of all organs' skins at rest that is charred in the window / area of the bed at rest that comes free "
      "in it; bed as in connective-remaining");
  return d;
}

class BurnPerFat final : public Checkpoint {
 public:
  explicit BurnPerFat(const AttemptContext& context)
      : notApplicable_(context.scene.fat == 0 ? "the scene has no fat" : whyNoPhases(context)) {}

  void onStep(const recorder::StepRecord& record, const Judgement& judgement) override {
    if (!notApplicable_.empty()) return;
    const Phase phase = judgement.phase;
    double volume = 0.0;
    for (const FatResult& fat : record.result.fat) volume += fat.volume;
    if (!whole_) whole_ = volume;
    charred_.add(phase, charredArea(record.result), record.step == 0);
    taken_.add(phase, *whole_ - volume, true);
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    const bool enough = whole_ && *whole_ > 0.0 && taken_.growth() >= leastShare * *whole_;
    const std::string why = !notApplicable_.empty() ? notApplicable_
                            : enough                ? ""
                                                    : "less than 1 % of the fat went in this phase";
    if (!why.empty()) return {makeMissing(fatDefinition(), "", end.origin, Availability::notApplicable, why)};
    return {makeValue(fatDefinition(), "", end.origin, charred_.growth() / taken_.growth())};
  }

 private:
  std::string notApplicable_;
  std::optional<double> whole_;  ///< volume after the first step (m^3)
  GrowthInPhase charred_{Phase::identification}, taken_{Phase::identification};
};

class BurnPerDissection final : public Checkpoint {
 public:
  explicit BurnPerDissection(const AttemptContext& context)
      : bed_(context), notApplicable_(bed_.notApplicable().empty() ? whyNoPhases(context) : bed_.notApplicable()) {
    if (notApplicable_.empty() && !(bed_.area() > 0.0)) notApplicable_ = "the bed has no area";
  }

  void onStep(const recorder::StepRecord& record, const Judgement& judgement) override {
    if (!notApplicable_.empty()) return;
    const Phase phase = judgement.phase;
    bed_.take(record.result);
    charred_.add(phase, charredArea(record.result), record.step == 0);
    freed_.add(phase, bed_.freedArea(), record.step == 0);
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    const bool enough = freed_.growth() >= leastShare * bed_.area();
    const std::string why = !notApplicable_.empty() ? notApplicable_
                            : enough                ? ""
                                                    : "less than 1 % of the bed came free in this phase";
    if (!why.empty()) return {makeMissing(bedDefinition(), "", end.origin, Availability::notApplicable, why)};
    return {makeValue(bedDefinition(), "", end.origin, charred_.growth() / freed_.growth())};
  }

 private:
  GallbladderBed bed_;
  std::string notApplicable_;
  GrowthInPhase charred_{Phase::dissection}, freed_{Phase::dissection};
};

}  // namespace

std::vector<CheckpointEntry> burnPerWorkEntries() {
  return {{{CheckpointFamily::safety, 60},
           fatDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<BurnPerFat>(context);
           }},
          {{CheckpointFamily::safety, 70},
           bedDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<BurnPerDissection>(context);
           }}};
}

}  // namespace calot::analytics
