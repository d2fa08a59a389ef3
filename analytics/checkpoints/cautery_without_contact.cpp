// SPDX-License-Identifier: GPL-3.0-or-later
// Current on a hook that touches nothing, debounced: a hook that hops over tissue is not held in the air.
#include "analytics/checkpoints/entries.h"

#include <array>

namespace calot::analytics {
namespace {

const CheckpointDefinition& definition() {
  static const CheckpointDefinition d{
      .name = "cautery-without-contact",
      .title = "Cautery without contact",
      .unit = "s",
      .displayUnit = "s",
      .displayFactor = 1.0,
      .direction = Direction::lower,
      .window = "whole attempt, while a hook is mounted",
      .aggregation = Aggregation::hand,
      .instruments = "each hand by itself",
      .filter = "stretches of at least 0.1 s; any touch of tissue, or current off, ends a stretch",
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 1,
      .definition =
          "sum of the lengths of the stretches of steps in which the hook carries current and touches nothing, "
          "without those under 0.1 s",
      .paperReading = "",
  };
  return d;
}

/// Shorter stretches do not count (s).
constexpr double leastStretch = 0.1;

class CauteryWithoutContact final : public Checkpoint {
 public:
  explicit CauteryWithoutContact(const AttemptContext& context)
      : tickSeconds_(context.tickSeconds), ticksPerStep_(context.ticksPerStep), tooOld_(whyTooOld(context, 3)) {}

  void onStep(const recorder::StepRecord& record) override {
    for (std::size_t h = 0; h < hand_.size(); ++h) {
      const HandResult& result = record.result.hand[h];
      Hand& hand = hand_[h];
      hand.hook = hand.hook || result.instrument == InstrumentKind::hook;
      if (result.cautery == Cautery::withoutContact) {
        ++hand.stretch;
      } else {
        hand.counted += counts(hand.stretch);
        hand.stretch = 0;
      }
    }
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    std::vector<CheckpointValue> result;
    for (std::size_t h = 0; h < hand_.size(); ++h) {
      const Hand& hand = hand_[h];
      const std::string why = !tooOld_.empty() ? tooOld_ : hand.hook ? "" : "no hook in this hand";
      if (!why.empty()) {
        result.push_back(makeMissing(definition(), handNames[h], end.origin, Availability::notApplicable, why));
        continue;
      }
      result.push_back(makeValue(definition(), handNames[h], end.origin, seconds(hand.counted + counts(hand.stretch)),
                                 stretchNote(end)));
    }
    return result;
  }

 private:
  struct Hand {
    bool hook = false;
    std::uint64_t counted = 0;  ///< steps of the stretches that are over
    std::uint64_t stretch = 0;  ///< steps of the present one
  };
  [[nodiscard]] double seconds(std::uint64_t steps) const {
    return static_cast<double>(steps * ticksPerStep_) * tickSeconds_;
  }
  /// As many steps, if they are enough. Half a tick of room: lengths are products of rounded numbers.
  [[nodiscard]] std::uint64_t counts(std::uint64_t steps) const {
    return seconds(steps) + 0.5 * tickSeconds_ >= leastStretch ? steps : 0;
  }

  double tickSeconds_;
  std::uint64_t ticksPerStep_;
  std::string tooOld_;
  std::array<Hand, handCount> hand_;
};

}  // namespace

CheckpointEntry cauteryWithoutContactEntry() {
  return {definition(), [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
            return std::make_unique<CauteryWithoutContact>(context);
          }};
}

}  // namespace calot::analytics
