// SPDX-License-Identifier: GPL-3.0-or-later
// Connective tissue that was torn off rather than burned through, freed or not.
#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/gallbladder_bed.h"

namespace calot::analytics {
namespace {

const CheckpointDefinition& connectiveTornDefinition() {
  static const CheckpointDefinition d{
      .name = "connective-torn",
      .title = "Connective tissue torn so far",
      .unit = "1",
      .displayUnit = "%",
      .displayFactor = 100.0,
      .direction = Direction::lower,
      .window = "whole attempt, whatever came of it",
      .aggregation = Aggregation::attempt,
      .instruments = "union over instruments: what any of them tore",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 1,
      .definition = "area of the bed under torn strands / area of the whole bed; bed as in connective-remaining",
      .paperReading = "",
  };
  return d;
}

class ConnectiveTorn final : public Checkpoint {
 public:
  explicit ConnectiveTorn(const AttemptContext& context) : bed_(context) {}

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override { bed_.take(record.result); }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    if (!bed_.notApplicable().empty()) {
      return {
          makeMissing(connectiveTornDefinition(), "", end.origin, Availability::notApplicable, bed_.notApplicable())};
    }
    return {makeValue(connectiveTornDefinition(), "", end.origin, bed_.torn())};
  }

 private:
  GallbladderBed bed_;
};

}  // namespace

std::vector<CheckpointEntry> connectiveTornEntries() {
  return {{{CheckpointFamily::safety, 30},
           connectiveTornDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<ConnectiveTorn>(context);
           }}};
}

}  // namespace calot::analytics
