// SPDX-License-Identifier: GPL-3.0-or-later
// What is left of the connective tissue once the gallbladder is off its bed: strands that tore instead of being burned.
#include "analytics/checkpoints/checkpoint.h"

#include <fmt/format.h>

#include "analytics/checkpoints/gallbladder_bed.h"

namespace calot::analytics {
namespace {

const CheckpointDefinition& connectiveRemainingDefinition() {
  static const CheckpointDefinition d{
      .name = "connective-remaining",
      .title = "Connective tissue left after the gallbladder's removal",
      .unit = "1",
      .displayUnit = "%",
      .displayFactor = 100.0,
      .direction = Direction::lower,
      .window = "whole attempt, those in which the gallbladder came free only",
      .aggregation = Aggregation::attempt,
      .instruments = "union over instruments: what any of them burned or tore",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 1,
      .definition =
          "R = area of the bed under torn strands at the end / area of the whole bed, once no strand is "
          "attached any more; bed: connective tissue of role cystic-plate",
      .paperReading =
          "Remaining connective tissue (%), in its text \"remaining connective tissue after the gallbladder "
          "removal\": what is neither burned away nor attached, as a share of the bed's initial area",
  };
  return d;
}

/// Sums of areas: what is attached beyond it is a strand.
constexpr double noShare = 1e-9;

class ConnectiveRemaining final : public Checkpoint {
 public:
  explicit ConnectiveRemaining(const AttemptContext& context) : bed_(context) {}

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override { bed_.take(record.result); }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    if (!bed_.notApplicable().empty()) {
      return {makeMissing(connectiveRemainingDefinition(), "", end.origin, Availability::notApplicable,
                          bed_.notApplicable())};
    }
    if (bed_.attached() > noShare) {
      return {makeMissing(
          connectiveRemainingDefinition(), "", end.origin, Availability::notAvailable,
          fmt::format("the gallbladder was not freed: {:.1f} % of its bed attached", bed_.attached() * 100.0))};
    }
    return {makeValue(connectiveRemainingDefinition(), "", end.origin, bed_.torn())};
  }

 private:
  GallbladderBed bed_;
};

}  // namespace

std::vector<CheckpointEntry> connectiveRemainingEntries() {
  return {{{CheckpointFamily::paper, 70, "connective"},
           connectiveRemainingDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<ConnectiveRemaining>(context);
           }}};
}

}  // namespace calot::analytics
