// SPDX-License-Identifier: GPL-3.0-or-later
// The family of haptic force: largest, 99th percentile, mean, impulse and rate of change of what each hand felt.
#include "analytics/checkpoints/checkpoint.h"

#include <algorithm>

#include "analytics/checkpoints/force.h"
#include "analytics/statistics/descriptive.h"

namespace calot::analytics {
namespace {

CheckpointDefinition forceFigure(const char* name, const char* title, const char* formula, const char* filter) {
  return {
      .name = name,
      .title = title,
      .unit = "N",
      .displayUnit = "N",
      .displayFactor = 1.0,
      .direction = Direction::lower,
      .window = "whole attempt, while an instrument is mounted",
      .aggregation = Aggregation::hand,
      .instruments = "each hand by itself",
      .filter = filter,
      .origins = {Origin::resimulated, Origin::observables},
      .finality = Finality::running,
      .version = 1,
      .definition = formula,
      .paperReading = "",
  };
}

const CheckpointDefinition& maximumDefinition() {
  static const CheckpointDefinition d =
      forceFigure("force-maximum", "Largest haptic force", "max |f_W| over all ticks", "none");
  return d;
}

const CheckpointDefinition& percentileForceDefinition() {
  static const CheckpointDefinition d = forceFigure(
      "force-p99", "99th percentile of the haptic force",
      "quantile of type 7 at 0.99 of |f_W| over the ticks with |f_W| >= 0.01 N", "ticks of at least 0.01 N");
  return d;
}

const CheckpointDefinition& meanForceDefinition() {
  static const CheckpointDefinition d =
      forceFigure("force-mean", "Mean non-zero haptic force", "mean of |f_W| over the ticks with |f_W| >= 0.01 N",
                  "ticks of at least 0.01 N");
  return d;
}

const CheckpointDefinition& impulseDefinition() {
  static const CheckpointDefinition d = [] {
    CheckpointDefinition impulse = forceFigure("force-impulse", "Impulse of the haptic force",
                                               "tick length * sum of |f_W| over all ticks", "none");
    impulse.unit = impulse.displayUnit = "N s";
    return impulse;
  }();
  return d;
}

const CheckpointDefinition& rateDefinition() {
  static const CheckpointDefinition d = [] {
    CheckpointDefinition rate = forceFigure(
        "force-rate-p95", "95th percentile of the haptic force's rate of change",
        "quantile of type 7 at 0.95 of |f_W(t+1) - f_W(t-1)| / (2 ticks) over the ticks t with |f_W(t)| >= 0.01 N",
        "ticks of at least 0.01 N; central differences");
    rate.unit = rate.displayUnit = "N/s";
    return rate;
  }();
  return d;
}

struct ForceMeasure {
  double (*figure)(const ForceTrack& track, int hand);
  bool needsFelt;  ///< without a force of leastForce there is none
};

CheckpointValue forceValue(const CheckpointDefinition& definition, std::string subject, const ForceTrack& track,
                           int hand, const ForceMeasure& measure, Origin origin) {
  const auto missing = [&](Availability kind, const char* why) {
    return makeMissing(definition, std::move(subject), origin, kind, why);
  };
  if (!track.mounted(hand)) return missing(Availability::absentHand, "no instrument in this hand");
  if (measure.needsFelt && track.felt(hand).empty())
    return missing(Availability::notApplicable, "no force of 0.01 N or more");
  return makeValue(definition, std::move(subject), origin, measure.figure(track, hand));
}

class OfHands final : public Checkpoint {
 public:
  OfHands(const CheckpointDefinition& definition, const ForceMeasure& measure)
      : definition_(definition), measure_(measure) {}

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    std::vector<CheckpointValue> result;
    result.reserve(handCount);
    for (int h = 0; h < handCount; ++h) {
      result.push_back(
          forceValue(definition_, handNames[static_cast<std::size_t>(h)], *end.force, h, measure_, end.origin));
    }
    return result;
  }

 private:
  const CheckpointDefinition& definition_;
  const ForceMeasure& measure_;
};

class OfHandsInPhases final : public Checkpoint {
 public:
  OfHandsInPhases(const CheckpointDefinition& definition, const ForceMeasure& measure, const AttemptContext& context)
      : definition_(definition), measure_(measure), notApplicable_(whyNoPhases(context)) {}

  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    if (!notApplicable_.empty())
      return {makeMissing(definition_, "", end.origin, Availability::notApplicable, notApplicable_)};
    std::vector<CheckpointValue> result;
    for (std::size_t w = 0; w < windowPhases.size(); ++w) {
      for (int h = 0; h < handCount; ++h) {
        std::string subject = handAndPhase(static_cast<std::size_t>(h), windowPhases[w]);
        result.push_back(
            (*end.phases)[w].seconds > 0.0
                ? forceValue(definition_, std::move(subject), end.phaseForce->of(w), h, measure_, end.origin)
                : makeMissing(definition_, std::move(subject), end.origin, Availability::notApplicable, noSuchPhase));
      }
    }
    return result;
  }

 private:
  const CheckpointDefinition& definition_;
  const ForceMeasure& measure_;
  std::string notApplicable_;
};

double maximumOf(const ForceTrack& track, int hand) { return track.largest(hand); }

double quantileOf(std::vector<double> values, double p) {
  std::sort(values.begin(), values.end());
  return quantileOfSorted(values, p);
}

double percentileForceOf(const ForceTrack& track, int hand) { return quantileOf(track.felt(hand), 0.99); }

double impulseOf(const ForceTrack& track, int hand) { return track.impulse(hand); }

/// A force that was felt at the first or the last tick alone has no rate of change.
double rateOf(const ForceTrack& track, int hand) {
  return track.rates(hand).empty() ? 0.0 : quantileOf(track.rates(hand), 0.95);
}

double meanForceOf(const ForceTrack& track, int hand) {
  double sum = 0.0;
  for (const double f : track.felt(hand)) sum += f;
  return sum / static_cast<double>(track.felt(hand).size());
}

constexpr ForceMeasure maximumMeasure{maximumOf, false}, percentileMeasure{percentileForceOf, true},
    meanMeasure{meanForceOf, true}, impulseMeasure{impulseOf, false}, rateMeasure{rateOf, true};

template <const CheckpointDefinition& (*definition)(), const ForceMeasure& measure>
CheckpointEntry entryOf(int rank) {
  return {{CheckpointFamily::contact, rank}, definition(), [](const AttemptContext&) -> std::unique_ptr<Checkpoint> {
            return std::make_unique<OfHands>(definition(), measure);
          }};
}

template <const CheckpointDefinition& (*definition)(), const ForceMeasure& measure>
CheckpointEntry phaseEntryOf(int rank) {
  static const CheckpointDefinition d = phaseDefinition(definition(), "ticks");
  return {{CheckpointFamily::phases, rank}, d, [](const AttemptContext& context) -> std::unique_ptr<Checkpoint> {
            return std::make_unique<OfHandsInPhases>(d, measure, context);
          }};
}

}  // namespace

std::vector<CheckpointEntry> forceEntries() {
  return {entryOf<maximumDefinition, maximumMeasure>(50),
          entryOf<percentileForceDefinition, percentileMeasure>(60),
          entryOf<meanForceDefinition, meanMeasure>(70),
          entryOf<impulseDefinition, impulseMeasure>(80),
          entryOf<rateDefinition, rateMeasure>(90),
          phaseEntryOf<maximumDefinition, maximumMeasure>(110),
          phaseEntryOf<percentileForceDefinition, percentileMeasure>(120),
          phaseEntryOf<impulseDefinition, impulseMeasure>(130)};
}

}  // namespace calot::analytics
