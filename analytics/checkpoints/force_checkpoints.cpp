// SPDX-License-Identifier: GPL-3.0-or-later
// The family of haptic force: largest, 99th percentile and mean of what each hand felt.
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

double percentileOf(const ForceTrack& track, int hand) {
  std::vector<double> sorted = track.felt(hand);
  std::sort(sorted.begin(), sorted.end());
  return quantileOfSorted(sorted, 0.99);
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

}  // namespace calot::analytics
