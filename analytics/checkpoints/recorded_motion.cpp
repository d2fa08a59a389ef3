// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/recorded_motion.h"

#include "recorder/sources/tracked_motion.h"

namespace calot::analytics {

MotionTrack trackFor(const recorder::AttemptHeader& header) {
  // A kinematics file's rows were interpolated to ticks by its source; a device that plays one holds them.
  const recorder::Provenance& from = header.provenance;
  const bool interpolated = from.kind == recorder::OperatorKind::kinematics && from.device.empty();
  return MotionTrack(header.tickSeconds, interpolated ? recorder::kinematicsRowsPerSecond : 0.0);
}

std::array<Motion, handCount> motionOf(recorder::Recording& recording, double cutoff) {
  std::array<MotionTrack, handCount> track{trackFor(recording.header()), trackFor(recording.header())};
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    for (const TickSamples& tick : recording.step(n).samples) {
      for (std::size_t h = 0; h < track.size(); ++h) track[h].add(tick.hand[h]);
    }
  }
  return {track[0].motion(cutoff), track[1].motion(cutoff)};
}

}  // namespace calot::analytics
