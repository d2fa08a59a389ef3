// SPDX-License-Identifier: GPL-3.0-or-later
// Clips that were lost or sit badly, by the geometric rules of the step (docs/explanation/vessels.md).
#include "analytics/checkpoints/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>

namespace calot::analytics {
namespace {

const CheckpointDefinition& clipErrorsDefinition() {
  static const CheckpointDefinition d{
      .name = "clip-errors",
      .title = "Clips misplaced or lost",
      .unit = "1",
      .displayUnit = "1",
      .displayFactor = 1.0,
      .direction = Direction::lower,
      .window = "whole attempt",
      .aggregation = Aggregation::attempt,
      .instruments = "sum over instruments",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = judgedVersion(1),
      .definition =
          "E = #{clips set half on, on another clip, too near to something, or on a vessel that is not cystic} "
          "+ #{clips dropped}; a clip with several faults counts once",
      .paperReading = "",
  };
  return d;
}

class ClipErrors final : public Checkpoint {
 public:
  explicit ClipErrors(const AttemptContext& context)
      : organs_(context.scene.organ.size()),
        vessel_(context.scene.vessel),
        notApplicable_(vessel_.empty() ? "the scene has no vessels" : whyTooOld(context, 3)) {}

  void onStep(const recorder::StepRecord& /*record*/, const Judgement& judgement) override {
    const std::vector<Event>& events = judgement.events;
    for (const Event& event : events) {
      if (event.kind == EventKind::clipDropped) ++dropped_;
      if (event.kind != EventKind::clipSet) continue;
      ++set_;
      // What is wrong with a clip is told beside it, in the same step, of the same hand.
      const auto beside = [&](EventKind kind) {
        return std::any_of(events.begin(), events.end(),
                           [&](const Event& e) { return e.kind == kind && e.hand == event.hand; });
      };
      const bool halfOn = beside(EventKind::clipHalfOn);
      const bool onClip = beside(EventKind::clipOnClip);
      const bool tooNear = beside(EventKind::clipTooNear);
      const bool elsewhere = !isCystic(event.subject);
      halfOn_ += halfOn ? 1 : 0;
      onClip_ += onClip ? 1 : 0;
      tooNear_ += tooNear ? 1 : 0;
      elsewhere_ += elsewhere ? 1 : 0;
      faulty_ += halfOn || onClip || tooNear || elsewhere ? 1 : 0;
    }
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    const auto missing = [&](const std::string& why) {
      return std::vector<CheckpointValue>{
          makeMissing(clipErrorsDefinition(), "", end.origin, Availability::notApplicable, why)};
    };
    if (!notApplicable_.empty()) return missing(notApplicable_);
    if (set_ + dropped_ == 0) return missing("no clip was set or dropped");
    return {
        makeValue(clipErrorsDefinition(), "", end.origin, static_cast<double>(faulty_ + dropped_),
                  fmt::format("{} set; half on {}, on another clip {}, too near {}, on another vessel {}, dropped {}",
                              set_, halfOn_, onClip_, tooNear_, elsewhere_, dropped_))};
  }

 private:
  [[nodiscard]] bool isCystic(std::size_t structure) const {
    return structure >= organs_ && structure - organs_ < vessel_.size() && vessel_[structure - organs_].cystic;
  }

  std::size_t organs_;
  std::vector<SceneFacts::Vessel> vessel_;
  std::string notApplicable_;
  std::uint64_t set_ = 0, dropped_ = 0, faulty_ = 0;
  std::uint64_t halfOn_ = 0, onClip_ = 0, tooNear_ = 0, elsewhere_ = 0;
};

}  // namespace

std::vector<CheckpointEntry> clipErrorsEntries() {
  return {{{CheckpointFamily::safety, 10},
           clipErrorsDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<ClipErrors>(context);
           }}};
}

}  // namespace calot::analytics
