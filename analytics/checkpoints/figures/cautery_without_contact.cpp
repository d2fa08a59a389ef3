// SPDX-License-Identifier: GPL-3.0-or-later
// Current on a hook that touches nothing, debounced: a hook that hops over tissue is not held in the air.
#include "analytics/checkpoints/checkpoint.h"

#include <utility>

#include "analytics/checkpoints/phases.h"
#include "sim/instruments/instruments.h"

namespace calot::analytics {
namespace {

const CheckpointDefinition& cauteryWithoutContactDefinition() {
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
constexpr double minStretch = 0.1;

/// One hook's current in the air.
class CurrentInTheAir {
 public:
  explicit CurrentInTheAir(const AttemptContext& context)
      : tickSeconds_(context.tickSeconds), ticksPerStep_(context.ticksPerStep) {}

  void add(const HandResult& result) {
    hook_ = hook_ || instrumentOf(result.instrument).action == InstrumentAction::burn;
    if (result.cautery == Cautery::withoutContact) {
      ++stretch_;
    } else {
      endStretch();
    }
  }
  void endStretch() {
    counted_ += counts(stretch_);
    stretch_ = 0;
  }
  [[nodiscard]] bool hook() const { return hook_; }  ///< one was mounted at any time
  /// Of all stretches that are long enough, the present one among them.
  [[nodiscard]] double seconds() const { return secondsOf(counted_ + counts(stretch_)); }

 private:
  [[nodiscard]] double secondsOf(std::uint64_t steps) const {
    return static_cast<double>(steps * ticksPerStep_) * tickSeconds_;
  }
  /// As many steps, if they are enough. Half a tick of room: lengths are products of rounded numbers.
  [[nodiscard]] std::uint64_t counts(std::uint64_t steps) const {
    return secondsOf(steps) + 0.5 * tickSeconds_ >= minStretch ? steps : 0;
  }

  double tickSeconds_;
  std::uint64_t ticksPerStep_;
  bool hook_ = false;
  std::uint64_t counted_ = 0;  ///< steps of the stretches that are over
  std::uint64_t stretch_ = 0;  ///< steps of the present one
};

using BothHands = std::vector<CurrentInTheAir>;

CheckpointValue valueOf(const CheckpointDefinition& d, std::string subject, const CurrentInTheAir& hand,
                        const AttemptEnd& end) {
  if (!hand.hook())
    return makeMissing(d, std::move(subject), end.origin, Availability::notApplicable, "no hook in this hand");
  return makeValue(d, std::move(subject), end.origin, hand.seconds(), stretchNote(end));
}

class CauteryWithoutContact final : public Checkpoint {
 public:
  explicit CauteryWithoutContact(const AttemptContext& context)
      : tooOld_(whyTooOld(context, 3)), hand_(handCount, CurrentInTheAir(context)) {}

  void onStep(const recorder::StepRecord& record, const Judgement& /*judgement*/) override {
    for (std::size_t h = 0; h < hand_.size(); ++h) hand_[h].add(record.result.hand[h]);
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    std::vector<CheckpointValue> result;
    for (std::size_t h = 0; h < hand_.size(); ++h) {
      result.push_back(tooOld_.empty() ? valueOf(cauteryWithoutContactDefinition(), handNames[h], hand_[h], end)
                                       : makeMissing(cauteryWithoutContactDefinition(), handNames[h], end.origin,
                                                     Availability::notApplicable, tooOld_));
    }
    return result;
  }

 private:
  std::string tooOld_;
  BothHands hand_;
};

const CheckpointDefinition& inPhases() {
  static const CheckpointDefinition d = phaseDefinition(cauteryWithoutContactDefinition(), "steps");
  return d;
}

/// A stretch that goes on into the next phase counts with each of its parts that is long enough.
class PhaseCauteryWithoutContact final : public Checkpoint {
 public:
  explicit PhaseCauteryWithoutContact(const AttemptContext& context)
      : notApplicable_(whyNoPhases(context)),
        window_(windowPhases.size(), BothHands(handCount, CurrentInTheAir(context))) {}

  void onStep(const recorder::StepRecord& record, const Judgement& judgement) override {
    const Phase phase = judgement.phase;
    if (phase != phase_) {
      for (BothHands& hands : window_) {
        for (CurrentInTheAir& hand : hands) hand.endStretch();
      }
    }
    phase_ = phase;
    const std::size_t window = windowOf(phase);
    if (window == window_.size()) return;
    for (std::size_t h = 0; h < window_[window].size(); ++h) window_[window][h].add(record.result.hand[h]);
  }

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    if (!notApplicable_.empty())
      return {makeMissing(inPhases(), "", end.origin, Availability::notApplicable, notApplicable_)};
    std::vector<CheckpointValue> result;
    for (std::size_t w = 0; w < window_.size(); ++w) {
      for (std::size_t h = 0; h < window_[w].size(); ++h) {
        std::string subject = handAndPhase(h, windowPhases[w]);
        result.push_back((*end.phases)[w].seconds > 0.0 ? valueOf(inPhases(), std::move(subject), window_[w][h], end)
                                                        : makeMissing(inPhases(), std::move(subject), end.origin,
                                                                      Availability::notApplicable, noSuchPhase));
      }
    }
    return result;
  }

 private:
  std::string notApplicable_;
  std::vector<BothHands> window_;  ///< as windowPhases
  Phase phase_ = Phase::none;
};

}  // namespace

std::vector<CheckpointEntry> cauteryWithoutContactEntries() {
  return {
      {{CheckpointFamily::safety, 20},
       cauteryWithoutContactDefinition(),
       [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
         return std::make_unique<CauteryWithoutContact>(context);
       }},
      {{CheckpointFamily::phases, 150}, inPhases(), [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
         return std::make_unique<PhaseCauteryWithoutContact>(context);
       }}};
}

}  // namespace calot::analytics
