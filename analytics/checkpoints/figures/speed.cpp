// SPDX-License-Identifier: GPL-3.0-or-later
// Speed of the tip: mean and 95th percentile. A raw maximum is noise.
#include "analytics/checkpoints/checkpoint.h"

#include <algorithm>

#include "analytics/checkpoints/hand_motion.h"
#include "analytics/statistics/descriptive.h"

namespace calot::analytics {
namespace {

CheckpointDefinition speedFigure(const char* name, const char* title, const char* formula) {
  CheckpointDefinition d = motionDefinition(name, title, "m/s", Direction::none, formula);
  d.displayUnit = "mm/s";
  d.displayFactor = 1000.0;
  return d;
}

const CheckpointDefinition& meanDefinition() {
  static const CheckpointDefinition d =
      speedFigure("speed-mean", "Mean speed of the instrument's tip",
                  "mean of v(k) over all points; v(k) = |p(k+1) - p(k-1)| * 50 Hz of the "
                  "filtered tip, one-sided at the ends of a segment");
  return d;
}

const CheckpointDefinition& percentileDefinition() {
  static const CheckpointDefinition d =
      speedFigure("speed-p95", "95th percentile of the tip's speed",
                  "quantile of type 7 at 0.95 of v(k) over all points, v as in speed-mean");
  return d;
}

Measured meanOf(const Motion& motion) {
  double sum = 0.0;
  for (const MotionSegment& segment : motion.segments) {
    for (const double v : segment.speed) sum += v;
  }
  return Measured::of(sum / static_cast<double>(motion.points()));
}

Measured percentileOf(const Motion& motion) {
  std::vector<double> all;
  all.reserve(motion.points());
  for (const MotionSegment& segment : motion.segments)
    all.insert(all.end(), segment.speed.begin(), segment.speed.end());
  std::sort(all.begin(), all.end());
  return Measured::of(quantileOfSorted(all, 0.95));
}

}  // namespace

std::vector<CheckpointEntry> speedEntries() {
  return {{{CheckpointFamily::motion, 40},
           meanDefinition(),
           [](const AttemptContext&) { return perHand(meanDefinition(), meanOf); }},
          phaseMotionEntry<meanDefinition, meanOf>(50),
          {{CheckpointFamily::motion, 50}, percentileDefinition(), [](const AttemptContext&) {
             return perHand(percentileDefinition(), percentileOf);
           }}};
}

}  // namespace calot::analytics
