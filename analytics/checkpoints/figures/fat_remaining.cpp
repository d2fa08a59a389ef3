// SPDX-License-Identifier: GPL-3.0-or-later
// Fat that is left after identification: all of it (the paper's figure), and its two parts, which want opposite things.
#include "analytics/checkpoints/checkpoint.h"

#include <fmt/format.h>

namespace calot::analytics {
namespace {

enum class Part : std::uint8_t { all, inside, outside };

CheckpointDefinition fatFigure(const char* name, const char* title, Direction direction, const char* formula,
                               const char* paper) {
  return {
      .name = name,
      .title = title,
      .unit = "1",
      .displayUnit = "%",
      .displayFactor = 100.0,
      .direction = direction,
      .window =
          "from the first step to the end of the step that sets the first clip; without a clip, to the end of a "
          "completed attempt",
      .aggregation = Aggregation::attempt,
      .instruments = "union over instruments: what any of them took is gone",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::final,
      .version = 1,
      .definition = formula,
      .paperReading = paper,
  };
}

const CheckpointDefinition& allDefinition() {
  static const CheckpointDefinition d = fatFigure(
      "fat-remaining", "Fat left after identification", Direction::none,
      "F = V / V_0, V the volume of fat at rest at the end of the window, V_0 after the first step; all bodies of fat",
      "Remaining fat tissue (%): all fat, by volume, when the first clip ends identification; experts left more, "
      "though the task is to remove it, so this figure gets no direction and its two parts do");
  return d;
}

const CheckpointDefinition& insideDefinition() {
  static const CheckpointDefinition d = fatFigure(
      "fat-remaining-inside", "Fat left inside the triangle after identification", Direction::lower,
      "F_in = T / T_0, T the volume of fat inside the scene's region to be cleared at the end of the window, T_0 after "
      "the first step",
      "");
  return d;
}

const CheckpointDefinition& outsideDefinition() {
  static const CheckpointDefinition d =
      fatFigure("fat-remaining-outside", "Fat spared outside the triangle after identification", Direction::higher,
                "F_out = (V - T) / (V_0 - T_0): the share left of the fat outside the region to be cleared", "");
  return d;
}

class FatRemaining final : public Checkpoint {
 public:
  FatRemaining(const AttemptContext& context, Part part, const CheckpointDefinition& definition)
      : part_(part), definition_(definition) {
    if (context.scene.fat == 0) {
      notApplicable_ = "the scene has no fat";
    } else if (part != Part::all && !context.scene.triangle) {
      notApplicable_ = "the scene marks no region to be cleared";
    } else {
      notApplicable_ = whyTooOld(context, 3);
    }
  }

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    const double now = volumeOf(record.result);
    if (steps_++ == 0) {
      fromStart_ = record.step == 0;
      first_ = now;
    }
    last_ = now;
    if (clipped_) return;
    left_ = now;
    for (const VesselResult& vessel : record.result.vessel) clipped_ = clipped_ || vessel.clips > 0;
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    const auto missing = [&](Availability availability, std::string why) {
      return std::vector<CheckpointValue>{makeMissing(definition_, "", end.origin, availability, std::move(why))};
    };
    if (!notApplicable_.empty()) return missing(Availability::notApplicable, notApplicable_);
    if (steps_ == 0) return missing(Availability::notAvailable, "no step yet");
    if (!fromStart_) return missing(Availability::notAvailable, "the steps do not begin with the attempt's first");
    if (!(first_ > 0.0)) return missing(Availability::notApplicable, "there is no such fat at the start");
    const double share = left_ / first_;
    std::string note;
    if (clipped_) {
      // What was taken later is no part of identification, though the operator went back to it.
      const double later = (left_ - last_) / first_;
      if (later > 0.0) note = fmt::format("{:.1f} % more were taken after the first clip", later * 100.0);
    } else if (end.outcome == recorder::Outcome::completed) {
      note = "no clip was set: at the end of the attempt";
    } else if (end.outcome != recorder::Outcome::running) {
      return missing(Availability::notAvailable,
                     fmt::format("identification was not finished: no clip was set, {:.1f} % left", share * 100.0));
    }
    return {makeValue(definition_, "", end.origin, share, std::move(note))};
  }

 private:
  [[nodiscard]] double volumeOf(const StepResult& result) const {
    double volume = 0.0;
    for (const FatResult& fat : result.fat) {
      volume += part_ == Part::all ? fat.volume : part_ == Part::inside ? fat.toClear : fat.volume - fat.toClear;
    }
    return volume;
  }

  Part part_;
  const CheckpointDefinition& definition_;
  std::string notApplicable_;
  std::uint64_t steps_ = 0;
  bool fromStart_ = false;
  bool clipped_ = false;
  double first_ = 0.0;  ///< m^3
  double left_ = 0.0;   ///< when the window ended, or now
  double last_ = 0.0;   ///< now
};

}  // namespace

std::vector<CheckpointEntry> fatRemainingEntries() {
  return {{{CheckpointFamily::paper, 30, "fat"},
           allDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<FatRemaining>(context, Part::all, allDefinition());
           }},
          {{CheckpointFamily::paper, 40, "in"},
           insideDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<FatRemaining>(context, Part::inside, insideDefinition());
           }},
          {{CheckpointFamily::paper, 50, "out"},
           outsideDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<FatRemaining>(context, Part::outside, outsideDefinition());
           }}};
}

}  // namespace calot::analytics
