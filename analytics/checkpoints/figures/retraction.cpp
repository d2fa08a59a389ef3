// SPDX-License-Identifier: GPL-3.0-or-later
// How often the assistant was asked to retract more or less, and how often that was taken back.
#include <optional>

#include "analytics/checkpoints/checkpoint.h"

namespace calot::analytics {
namespace {

CheckpointDefinition retractionDefinition(const char* name, const char* title, Direction direction,
                                          const char* formula) {
  return {
      .name = name,
      .title = title,
      .unit = "1",
      .displayUnit = "1",
      .displayFactor = 1.0,
      .direction = direction,
      .window = "whole attempt",
      .aggregation = Aggregation::attempt,
      .instruments = "both together",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 1,
      .definition = formula,
      .paperReading = "",
  };
}

const CheckpointDefinition& requestsDefinition() {
  static const CheckpointDefinition d = retractionDefinition(
      "retraction-requests", "Times that the assistant was asked to retract more or less", Direction::none,
      "#{requests for more retraction} + #{requests for less}, those at a limit of the pull too");
  return d;
}

const CheckpointDefinition& reversalsDefinition() {
  static const CheckpointDefinition d = retractionDefinition(
      "retraction-reversals", "Times that a request to the assistant was taken back", Direction::lower,
      "#{requests for less whose last one before was for more, and the reverse}");
  return d;
}

class Retraction final : public Checkpoint {
 public:
  Retraction(const AttemptContext& context, bool reversals)
      : definition_(reversals ? reversalsDefinition() : requestsDefinition()),
        asked_(context.scene.retractionOnRequest),
        reversals_(reversals) {}

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    for (const Event& event : record.result.events) {
      if (event.kind != EventKind::retractionMore && event.kind != EventKind::retractionLess) continue;
      count_ += !reversals_ || (last_ && *last_ != event.kind) ? 1 : 0;
      last_ = event.kind;
    }
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    if (!asked_)
      return {makeMissing(definition_, "", end.origin, Availability::notApplicable,
                          "the scene has no retraction that can be asked for")};
    return {makeValue(definition_, "", end.origin, static_cast<double>(count_), {})};
  }

 private:
  const CheckpointDefinition& definition_;
  bool asked_;
  bool reversals_;
  std::optional<EventKind> last_;
  std::uint64_t count_ = 0;
};

}  // namespace

std::vector<CheckpointEntry> retractionEntries() {
  return {{{CheckpointFamily::motion, 210},
           requestsDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<Retraction>(context, false);
           }},
          {{CheckpointFamily::motion, 220},
           reversalsDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<Retraction>(context, true);
           }}};
}

}  // namespace calot::analytics
