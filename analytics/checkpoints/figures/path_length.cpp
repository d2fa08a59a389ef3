// SPDX-License-Identifier: GPL-3.0-or-later
// Path length of the real tip. Unfiltered it measures the tracker's noise: 0.2 mm at 100 Hz lengthen it by 42 %.
#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/hand_motion.h"
#include "analytics/checkpoints/movements.h"

namespace calot::analytics {
namespace {

const CheckpointDefinition& pathLengthDefinition() {
  static const CheckpointDefinition d = [] {
    CheckpointDefinition whole =
        motionDefinition("path-length", "Path length of the instrument's tip", "m", Direction::lower,
                         "L = sum |p(k+1) - p(k)| over the filtered points of the real tip p_WI, within segments");
    whole.displayUnit = "mm";
    whole.displayFactor = 1000.0;
    whole.version = 3;
    whole.paperReading =
        "Total trajectory dist. (left), (right) (mm): path of the real tip in the world, not of the "
        "device's handle nor of the simulated tip";
    return whole;
  }();
  return d;
}

Measured pathLengthOf(const Motion& motion) { return Measured::of(pathLength(motion)); }

}  // namespace

std::vector<CheckpointEntry> pathLengthEntries() {
  return {{{CheckpointFamily::paper, 20, "path"},
           pathLengthDefinition(),
           [](const AttemptContext&) { return perHand(pathLengthDefinition(), pathLengthOf); }},
          phaseMotionEntry<pathLengthDefinition, pathLengthOf>(20)};
}

}  // namespace calot::analytics
