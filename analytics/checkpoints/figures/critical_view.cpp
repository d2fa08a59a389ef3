// SPDX-License-Identifier: GPL-3.0-or-later
// The critical view of safety at the first clip.
#include "analytics/checkpoints/checkpoint.h"

#include <fmt/format.h>

namespace calot::analytics {
namespace {

const CheckpointDefinition& criticalViewDefinition() {
  static const CheckpointDefinition d{
      .name = "critical-view",
      .title = "Critical view of safety",
      .unit = "1",
      .displayUnit = "points",
      .displayFactor = 1.0,
      .direction = Direction::higher,
      .window = "until the first clip, where the view is frozen",
      .aggregation = Aggregation::attempt,
      .instruments = "none",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::final,
      .version = judgedVersion(1),
      .definition =
          "sum of 0 to 2 points each for the cleared triangle, the freed lower third of the bed, and two "
          "structures alone entering the gallbladder; satisfactory from 5 of 6",
      .paperReading = "",
  };
  return d;
}

class CriticalView final : public Checkpoint {
 public:
  explicit CriticalView(const AttemptContext& context)
      : notApplicable_(!context.procedure           ? "the scene has no procedure"
                       : !context.scene.hasCystic() ? "the scene has no duct or artery that enters a gallbladder"
                                                    : whyTooOld(context, 3)) {}

  void onStep(const recorder::StepRecord& /*record*/, const Judgement& judgement) override { view_ = judgement; }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    if (!notApplicable_.empty()) {
      return {makeMissing(criticalViewDefinition(), "", end.origin, Availability::notApplicable, notApplicable_)};
    }
    const int points = view_.criticalView();
    if (!view_.criticalViewFrozen && end.outcome != recorder::Outcome::running) {
      return {makeMissing(criticalViewDefinition(), "", end.origin, Availability::notAvailable,
                          fmt::format("no clip was set: {} of 6 points at the end", points))};
    }
    return {makeValue(criticalViewDefinition(), "", end.origin, static_cast<double>(points),
                      fmt::format("triangle {}, lower third {}, two structures {}", view_.triangleCleared,
                                  view_.lowerThirdFreed, view_.twoStructures))};
  }

 private:
  std::string notApplicable_;
  ProcedureStatus view_;
};

}  // namespace

std::vector<CheckpointEntry> criticalViewEntries() {
  return {{{CheckpointFamily::safety, 80},
           criticalViewDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<CriticalView>(context);
           }}};
}

}  // namespace calot::analytics
