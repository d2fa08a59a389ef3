// SPDX-License-Identifier: GPL-3.0-or-later
// The family of haptic force: largest, 99th percentile, mean, impulse and rate of change of what each hand felt.
#include "analytics/checkpoints/entries.h"

#include <algorithm>

#include "analytics/checkpoints/force.h"
#include "analytics/statistics/descriptive.h"

namespace calot::analytics {
namespace {

CheckpointDefinition familyMember(const char* name, const char* title, const char* formula, const char* filter) {
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
      familyMember("force-maximum", "Largest haptic force", "max |f_W| over all ticks", "none");
  return d;
}

const CheckpointDefinition& percentileDefinition() {
  static const CheckpointDefinition d = familyMember(
      "force-p99", "99th percentile of the haptic force",
      "quantile of type 7 at 0.99 of |f_W| over the ticks with |f_W| >= 0.01 N", "ticks of at least 0.01 N");
  return d;
}

const CheckpointDefinition& meanDefinition() {
  static const CheckpointDefinition d =
      familyMember("force-mean", "Mean non-zero haptic force", "mean of |f_W| over the ticks with |f_W| >= 0.01 N",
                   "ticks of at least 0.01 N");
  return d;
}

const CheckpointDefinition& impulseDefinition() {
  static const CheckpointDefinition d = [] {
    CheckpointDefinition impulse = familyMember("force-impulse", "Impulse of the haptic force",
                                                "tick length * sum of |f_W| over all ticks", "none");
    impulse.unit = impulse.displayUnit = "N s";
    return impulse;
  }();
  return d;
}

const CheckpointDefinition& rateDefinition() {
  static const CheckpointDefinition d = [] {
    CheckpointDefinition rate = familyMember(
        "force-rate-p95", "95th percentile of the haptic force's rate of change",
        "quantile of type 7 at 0.95 of |f_W(t+1) - f_W(t-1)| / (2 ticks) over the ticks t with |f_W(t)| >= 0.01 N",
        "ticks of at least 0.01 N; central differences");
    rate.unit = rate.displayUnit = "N/s";
    return rate;
  }();
  return d;
}

/// One member: `figure` gives its value from the track, @pre for members other than the maximum: something was felt.
template <const CheckpointDefinition& (*definition)(), double (*figure)(const ForceTrack&, int), bool needsFelt>
class Force final : public Checkpoint {
 public:
  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const override {
    const ForceTrack& track = *end.force;
    std::vector<CheckpointValue> result;
    for (int h = 0; h < handCount; ++h) {
      const char* hand = handNames[static_cast<std::size_t>(h)];
      if (!track.mounted(h)) {
        result.push_back(
            makeMissing(definition(), hand, end.origin, Availability::notApplicable, "no instrument in this hand"));
      } else if (needsFelt && track.felt(h).empty()) {
        result.push_back(
            makeMissing(definition(), hand, end.origin, Availability::notApplicable, "no force of 0.01 N or more"));
      } else {
        result.push_back(makeValue(definition(), hand, end.origin, figure(track, h)));
      }
    }
    return result;
  }
};

double maximumOf(const ForceTrack& track, int hand) { return track.largest(hand); }

double quantileOf(std::vector<double> values, double p) {
  std::sort(values.begin(), values.end());
  return quantileOfSorted(values, p);
}

double percentileOf(const ForceTrack& track, int hand) { return quantileOf(track.felt(hand), 0.99); }

double impulseOf(const ForceTrack& track, int hand) { return track.impulse(hand); }

/// A force that was felt at the first or the last tick alone has no rate of change.
double rateOf(const ForceTrack& track, int hand) {
  return track.rates(hand).empty() ? 0.0 : quantileOf(track.rates(hand), 0.95);
}

double meanOf(const ForceTrack& track, int hand) {
  double sum = 0.0;
  for (const double f : track.felt(hand)) sum += f;
  return sum / static_cast<double>(track.felt(hand).size());
}

}  // namespace

CheckpointEntry forceMaximumEntry() {
  return {maximumDefinition(), [](const AttemptContext&) -> std::unique_ptr<Checkpoint> {
            return std::make_unique<Force<maximumDefinition, maximumOf, false>>();
          }};
}

CheckpointEntry forcePercentileEntry() {
  return {percentileDefinition(), [](const AttemptContext&) -> std::unique_ptr<Checkpoint> {
            return std::make_unique<Force<percentileDefinition, percentileOf, true>>();
          }};
}

CheckpointEntry forceMeanEntry() {
  return {meanDefinition(), [](const AttemptContext&) -> std::unique_ptr<Checkpoint> {
            return std::make_unique<Force<meanDefinition, meanOf, true>>();
          }};
}

CheckpointEntry forceImpulseEntry() {
  return {impulseDefinition(), [](const AttemptContext&) -> std::unique_ptr<Checkpoint> {
            return std::make_unique<Force<impulseDefinition, impulseOf, false>>();
          }};
}

CheckpointEntry forceRateEntry() {
  return {rateDefinition(), [](const AttemptContext&) -> std::unique_ptr<Checkpoint> {
            return std::make_unique<Force<rateDefinition, rateOf, true>>();
          }};
}

}  // namespace calot::analytics
