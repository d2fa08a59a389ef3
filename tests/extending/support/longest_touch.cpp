// SPDX-License-Identifier: GPL-3.0-or-later
// Longest time without a break in which an instrument touches an organ: an example of a checkpoint. As one of Calot's
// it would stand in analytics/checkpoints/figures.
#include "analytics/checkpoints/checkpoint.h"

#include <algorithm>

namespace calot::analytics {
namespace {

const CheckpointDefinition& longestTouchDefinition() {
  static const CheckpointDefinition d{
      .name = "longest-touch",
      .title = "Longest touch of the organ",
      .unit = "s",
      .displayUnit = "s",
      .displayFactor = 1.0,
      .direction = Direction::lower,
      .window = "whole attempt",
      .aggregation = Aggregation::organ,
      .instruments = "union over instruments: any of them goes on with the touch",
      .filter = "none",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 1,
      .definition = "step length * most steps one after the other at whose end an instrument exerts a force on organ o",
      .paperReading = "",
  };
  return d;
}

class LongestTouch final : public Checkpoint {
 public:
  explicit LongestTouch(const AttemptContext& context)
      : stepLength_(context.tickSeconds * context.ticksPerStep),
        organs_(context.structures),
        now_(organs_.size(), 0),
        longest_(organs_.size(), 0) {}

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    for (std::size_t o = 0; o < organs_.size(); ++o) {
      bool touched = false;
      for (const HandResult& hand : record.result.hand) touched = touched || (hand.contacts() >> o & 1U) != 0;
      now_[o] = touched ? now_[o] + 1 : 0;
      longest_[o] = std::max(longest_[o], now_[o]);
    }
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    std::vector<CheckpointValue> result;
    for (std::size_t o = 0; o < organs_.size(); ++o) {
      const double seconds = static_cast<double>(longest_[o]) * stepLength_;
      result.push_back(makeValue(longestTouchDefinition(), organs_[o], end.origin, seconds, stretchNote(end)));
    }
    return result;
  }

 private:
  double stepLength_;
  std::vector<std::string> organs_;
  std::vector<std::uint64_t> now_;
  std::vector<std::uint64_t> longest_;
};

}  // namespace

std::vector<CheckpointEntry> longestTouchEntries() {
  return {{{CheckpointFamily::contact, 25},
           longestTouchDefinition(),
           [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
             return std::make_unique<LongestTouch>(context);
           }}};
}

}  // namespace calot::analytics
