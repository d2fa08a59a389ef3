// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/force.h"

#include <algorithm>

namespace calot::analytics {

void ForceTrack::add(const recorder::StepRecord& record) {
  const std::size_t ticks = std::min(record.samples.size(), record.ticks.size());
  for (std::size_t t = 0; t < ticks; ++t) {
    for (std::size_t h = 0; h < static_cast<std::size_t>(handCount); ++h) {
      Newest& newest = newest_[h];
      if (record.samples[t].hand[h].instrument == InstrumentKind::none) {
        newest.ticks = 0;
        continue;
      }
      HandForces& hand = hand_[h];
      hand.mounted = true;
      const Vec3& f = record.ticks[t].hand[h].force;
      const double magnitude = lengthOf(f);
      hand.largest = std::max(hand.largest, magnitude);
      hand.sum += magnitude;
      if (magnitude >= leastForce) hand.felt.push_back(magnitude);
      if (newest.ticks >= 2 && lengthOf(newest.force[1]) >= leastForce)
        hand.rates.push_back(lengthOf(f - newest.force[0]) / (2.0 * tickSeconds_));
      newest.force = {newest.force[1], f};
      newest.ticks = std::min(newest.ticks + 1, 2);
    }
  }
}

void ForceTrack::interrupt() {
  for (Newest& newest : newest_) newest.ticks = 0;
}

void PhaseForceTrack::add(const recorder::StepRecord& record, Phase phase) {
  const std::size_t window = windowOf(phase);
  if (window < track_.size()) {
    if (phase != phase_) track_[window].interrupt();
    track_[window].add(record);
  }
  phase_ = phase;
}

}  // namespace calot::analytics
