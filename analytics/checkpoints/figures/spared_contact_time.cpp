// SPDX-License-Identifier: GPL-3.0-or-later
// Contact with vessels that are none of the operation's business, in both readings of several instruments at once.
#include "analytics/checkpoints/checkpoint.h"

#include <utility>

#include "analytics/checkpoints/vessel_contact.h"

namespace calot::analytics {
namespace {

CheckpointDefinition sparedFigure(const char* name, const char* title, const char* instruments, const char* formula) {
  return {
      .name = name,
      .title = title,
      .unit = "s",
      .displayUnit = "s",
      .displayFactor = 1.0,
      .direction = Direction::lower,
      .window = "whole attempt",
      .aggregation = Aggregation::attempt,
      .instruments = instruments,
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 2,
      .definition = formula,
      .paperReading = "",
  };
}

const CheckpointDefinition& unionDefinition() {
  static const CheckpointDefinition d = sparedFigure(
      "spared-contact-time-union", "Time touching a vessel that is to be spared (any instrument)",
      "union over instruments and over the vessels: two at once count once",
      "step length * #{steps at whose end any instrument exerts a force on, or holds, any vessel that the scene's "
      "procedure tells to spare}");
  return d;
}

const CheckpointDefinition& sumDefinition() {
  static const CheckpointDefinition d =
      sparedFigure("spared-contact-time-sum", "Time touching vessels that are to be spared (summed over instruments)",
                   "sum over instruments and over the vessels: two at once count twice",
                   "step length * sum over instruments and vessels that the scene's procedure tells to spare #{steps "
                   "at whose end the "
                   "one exerts a force on the other or holds it}");
  return d;
}

bool isSpared(const SceneFacts::Vessel& vessel) { return vessel.spared; }

class SparedContactTime final : public Checkpoint {
 public:
  SparedContactTime(const AttemptContext& context, bool sum)
      : contact_(context, isSpared),
        sum_(sum),
        notApplicable_(!context.procedure      ? "the scene has no procedure"
                       : !contact_.anyVessel() ? "the scene's procedure names no vessel to be spared"
                                               : whyTooOld(context, 3)) {}

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    contact_.add(record.result);
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    const CheckpointDefinition& d = sum_ ? sumDefinition() : unionDefinition();
    if (!notApplicable_.empty()) return {makeMissing(d, "", end.origin, Availability::notApplicable, notApplicable_)};
    std::string note = sum_ ? contact_.parts() : std::string();
    if (const std::string stretch = stretchNote(end); !stretch.empty()) note += (note.empty() ? "" : "; ") + stretch;
    return {makeValue(d, "", end.origin, sum_ ? contact_.sum() : contact_.united(), std::move(note))};
  }

 private:
  VesselContact contact_;
  bool sum_;
  std::string notApplicable_;
};

}  // namespace

std::vector<CheckpointEntry> sparedContactTimeEntries() {
  return {{{CheckpointFamily::contact, 30},
           unionDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<SparedContactTime>(context, false);
           }},
          {{CheckpointFamily::contact, 40},
           sumDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<SparedContactTime>(context, true);
           }}};
}

}  // namespace calot::analytics
