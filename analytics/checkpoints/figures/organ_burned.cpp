// SPDX-License-Identifier: GPL-3.0-or-later
// Share of each organ's skin that cautery charred.
#include "analytics/checkpoints/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>

namespace calot::analytics {
namespace {

const CheckpointDefinition& organBurnedDefinition() {
  static const CheckpointDefinition d{
      .name = "organ-burned",
      .title = "Share of the organ burned",
      .unit = "1",
      .displayUnit = "%",
      .displayFactor = 100.0,
      .direction = Direction::lower,
      .window = "whole attempt",
      .aggregation = Aggregation::organ,
      .instruments = "union over instruments: what any of them charred",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 2,
      .definition = "B(o) = area of the organ's skin that is charred / area of all its skin, both at rest",
      .paperReading =
          "Amount of liver burned, amount of gallbladder burned (%): by area of the surface, not by volume; "
          "the whole organ's surface, not only what can be seen or reached",
  };
  return d;
}

/// Organs that the paper's table asks for in any scene.
constexpr StructureRole askedFor[] = {StructureRole::liver, StructureRole::gallbladder};

class OrganBurned final : public Checkpoint {
 public:
  explicit OrganBurned(const AttemptContext& context)
      : organ_(context.scene.organ), tooOld_(whyTooOld(context, 3)), charred_(organ_.size(), 0.0) {}

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    if (!tooOld_.empty()) return;
    for (std::size_t o = 0; o < organ_.size(); ++o) charred_[o] = record.result.organ[o].charredArea;
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    std::vector<CheckpointValue> result;
    for (std::size_t o = 0; o < organ_.size(); ++o) {
      result.push_back(
          tooOld_.empty()
              ? makeValue(organBurnedDefinition(), organ_[o].name, end.origin, charred_[o] / organ_[o].skinArea)
              : makeMissing(organBurnedDefinition(), organ_[o].name, end.origin, Availability::notApplicable, tooOld_));
    }
    for (const StructureRole role : askedFor) {
      const bool there =
          std::any_of(organ_.begin(), organ_.end(), [&](const SceneFacts::Organ& organ) { return organ.role == role; });
      if (there) continue;
      result.push_back(makeMissing(organBurnedDefinition(), nameOf(role), end.origin, Availability::notApplicable,
                                   fmt::format("the scene has no {}", nameOf(role))));
    }
    return result;
  }

 private:
  std::vector<SceneFacts::Organ> organ_;
  std::string tooOld_;
  std::vector<double> charred_;  ///< m^2
};

}  // namespace

std::vector<CheckpointEntry> organBurnedEntries() {
  return {{{CheckpointFamily::paper, 80, "burned"},
           organBurnedDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<OrganBurned>(context);
           }}};
}

}  // namespace calot::analytics
