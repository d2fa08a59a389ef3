// SPDX-License-Identifier: GPL-3.0-or-later
// Time of collision with cystic duct and artery, in the one reading under which the paper's figure is possible.
#include "analytics/checkpoints/entries.h"

#include <fmt/format.h>

namespace calot::analytics {
namespace {

const CheckpointDefinition& definition() {
  static const CheckpointDefinition d{
      .name = "cystic-contact-time",
      .title = "Time colliding with cystic duct and artery",
      .unit = "s",
      .displayUnit = "s",
      .displayFactor = 1.0,
      .direction = Direction::lower,
      .window = "whole attempt",
      .aggregation = Aggregation::attempt,
      .instruments = "sum over instruments and over the vessels: two at once count twice",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 1,
      .definition =
          "C = step length * sum over instruments and cystic vessels #{steps at whose end a force acts between "
          "the two}; cystic: an end is grown to an organ of appearance \"gallbladder\"",
      .paperReading =
          "Time colliding cystic ducts (s), in its text \"collision time with the cystic duct and artery\": "
          "both vessels; 41.57 s in a task of 38.86 s can only be a sum over vessels or instruments, and "
          "this is the sum over both",
  };
  return d;
}

/// Bits of HandResult::touching.
constexpr std::size_t touchingBits = 32;

class CysticContactTime final : public Checkpoint {
 public:
  explicit CysticContactTime(const AttemptContext& context)
      : tickSeconds_(context.tickSeconds), ticksPerStep_(context.ticksPerStep) {
    const std::vector<SceneFacts::Vessel>& vessels = context.scene.vessel;
    for (std::size_t v = 0; v < vessels.size(); ++v) {
      const std::size_t structure = context.scene.organ.size() + v;
      if (!vessels[v].cystic || structure >= touchingBits) continue;
      mask_ |= std::uint32_t{1} << structure;
      names_.push_back(vessels[v].name);
    }
    steps_.resize(names_.size(), 0);
    notApplicable_ =
        names_.empty() ? "the scene has no duct or artery that enters a gallbladder" : whyTooOld(context, 3);
  }

  void onStep(const recorder::StepRecord& record) override {
    for (const HandResult& hand : record.result.hand) {
      std::size_t name = 0;
      for (std::size_t s = 0; s < touchingBits; ++s) {
        if ((mask_ >> s & 1U) == 0) continue;
        steps_[name++] += hand.touching >> s & 1U;
      }
    }
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    if (!notApplicable_.empty()) {
      return {makeMissing(definition(), "", end.origin, Availability::notApplicable, notApplicable_)};
    }
    std::uint64_t steps = 0;
    std::string note;
    for (std::size_t v = 0; v < steps_.size(); ++v) {
      steps += steps_[v];
      note += fmt::format("{}{} {:.2f} s", v == 0 ? "" : ", ", names_[v], seconds(steps_[v]));
    }
    const std::string stretch = stretchNote(end);
    if (!stretch.empty()) note += "; " + stretch;
    return {makeValue(definition(), "", end.origin, seconds(steps), std::move(note))};
  }

 private:
  [[nodiscard]] double seconds(std::uint64_t steps) const {
    return static_cast<double>(steps * ticksPerStep_) * tickSeconds_;
  }

  double tickSeconds_;
  std::uint64_t ticksPerStep_;
  std::uint32_t mask_ = 0;            ///< of `touching`
  std::vector<std::string> names_;    ///< of the vessels in it, by rising bits
  std::vector<std::uint64_t> steps_;  ///< as many; over both hands
  std::string notApplicable_;
};

}  // namespace

CheckpointEntry cysticContactTimeEntry() {
  return {definition(), [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
            return std::make_unique<CysticContactTime>(context);
          }};
}

}  // namespace calot::analytics
