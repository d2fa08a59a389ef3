// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/from_samples.h"

#include <algorithm>
#include <array>

#include "analytics/checkpoints/force.h"
#include "analytics/checkpoints/gap_bridge.h"
#include "analytics/checkpoints/phases.h"
#include "analytics/checkpoints/registry.h"

namespace calot::analytics {

Motion motionOf(const recorder::TrackedMotion& tracked, std::size_t hand, double cutoff) {
  const recorder::TrackedHand& rows = tracked.hand[hand];
  Motion motion;
  motion.cutoff = cutoff;
  if (!rows.present) return motion;
  // Rows of a fixed rate are counted, so that no time is rounded.
  const bool counted = tracked.rate > 0.0;
  const auto since = [&](std::size_t i) {
    return counted ? 1.0 / tracked.rate : tracked.time[i] - tracked.time[i - 1];
  };
  MotionSamples samples{SampleGrid(counted ? tracked.rate : 1.0), {}, 0.0, {}, rows.oriented};
  for (std::size_t i = 0; i < rows.position.size(); ++i) {
    const double time = counted ? static_cast<double>(i) : tracked.time[i];
    if (i > 0) samples.rate.add(since(i));
    if (i == 0 || since(i) > straightBridge) {
      samples.grid.begin(time, rows.position[i], rows.orientation[i], i > 0);
    } else {
      samples.grid.extend(time, rows.position[i], rows.orientation[i]);
    }
  }
  const GapRule rule(samples.rate.interval());
  samples.longestRate = rule.longestEven();
  samples.coverage.mounted = {{0.0, tracked.time.back()}};
  for (std::size_t i = 1; i < tracked.time.size(); ++i) {
    if (rule.isGap(since(i))) samples.coverage.lost.push_back({tracked.time[i] - rule.lost(since(i)), tracked.time[i]});
  }
  return filteredMotion(std::move(samples), cutoff);
}

std::vector<CheckpointValue> valuesFromSamples(const recorder::TrackedMotion& tracked, const SamplesContext& context) {
  const std::array<Motion, handCount> motion{motionOf(tracked, 0, context.cutoff),
                                             motionOf(tracked, 1, context.cutoff)};
  const std::vector<PhaseMotion> phases;
  AttemptContext attempt;
  attempt.handedness = context.handedness;
  AttemptEnd end;
  end.steps = tracked.time.size() - 1;
  attempt.ticksPerStep = 1;
  attempt.tickSeconds = tracked.time.back() / static_cast<double>(end.steps);
  const ForceTrack force(attempt.tickSeconds);
  end.outcome = context.outcome;
  end.origin = Origin::samples;
  end.motion = {&motion[0], &motion[1]};
  end.phases = &phases;
  end.force = &force;
  std::vector<CheckpointValue> values;
  for (const CheckpointEntry& entry : checkpointRegistry()) {
    const std::vector<Origin>& origins = entry.definition.origins;
    if (std::find(origins.begin(), origins.end(), Origin::samples) == origins.end()) continue;
    for (CheckpointValue& value : entry.make(attempt)->values(end)) values.push_back(std::move(value));
  }
  return values;
}

}  // namespace calot::analytics
