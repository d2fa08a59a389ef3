// SPDX-License-Identifier: GPL-3.0-or-later
// Organs opened by cautery or by tearing: a perforated gallbladder spills bile.
#include "analytics/checkpoints/checkpoint.h"

namespace calot::analytics {
namespace {

const CheckpointDefinition& organPerforationsDefinition() {
  static const CheckpointDefinition d{
      .name = "organ-perforations",
      .title = "Perforations of the organ",
      .unit = "1",
      .displayUnit = "1",
      .displayFactor = 1.0,
      .direction = Direction::lower,
      .window = "whole attempt",
      .aggregation = Aggregation::organ,
      .instruments = "sum over instruments",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 2,
      .definition = "P(o) = #{events organPerforated of organ o}; at most one an organ",
      .paperReading = "",
  };
  return d;
}

class OrganPerforations final : public Checkpoint {
 public:
  explicit OrganPerforations(const AttemptContext& context)
      : organ_(context.scene.organ), tooOld_(whyTooOld(context, 3)), count_(organ_.size(), 0) {}

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    for (const Event& event : record.result.events) {
      if (event.kind == EventKind::organPerforated && event.subject < count_.size()) ++count_[event.subject];
    }
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    std::vector<CheckpointValue> result;
    for (std::size_t o = 0; o < organ_.size(); ++o) {
      const std::string why = organ_[o].hasWall ? tooOld_ : "the scene gives this organ no wall that could be opened";
      result.push_back(why.empty() ? makeValue(organPerforationsDefinition(), organ_[o].name, end.origin,
                                               static_cast<double>(count_[o]))
                                   : makeMissing(organPerforationsDefinition(), organ_[o].name, end.origin,
                                                 Availability::notApplicable, why));
    }
    return result;
  }

 private:
  std::vector<SceneFacts::Organ> organ_;
  std::string tooOld_;
  std::vector<std::uint64_t> count_;
};

}  // namespace

std::vector<CheckpointEntry> organPerforationsEntries() {
  return {{{CheckpointFamily::safety, 40},
           organPerforationsDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<OrganPerforations>(context);
           }}};
}

}  // namespace calot::analytics
