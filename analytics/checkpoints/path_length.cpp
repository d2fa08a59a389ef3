// SPDX-License-Identifier: GPL-3.0-or-later
// Path length of the real tip. Unfiltered it measures the tracker's noise: 0.2 mm at 100 Hz lengthen it by 42 %.
#include "analytics/checkpoints/entries.h"
#include "analytics/checkpoints/hand_motion.h"
#include "analytics/checkpoints/movements.h"

namespace calot::analytics {
namespace {

CheckpointDefinition inMillimetres(CheckpointDefinition d) {
  d.displayUnit = "mm";
  d.displayFactor = 1000.0;
  return d;
}

const CheckpointDefinition& definition() {
  static const CheckpointDefinition d = [] {
    CheckpointDefinition whole = inMillimetres(
        motionDefinition("path-length", "Path length of the instrument's tip", "m", Direction::lower,
                         "L = sum |p(k+1) - p(k)| over the filtered points of the real tip p_WI, within segments"));
    whole.version = 2;
    whole.paperReading =
        "Total trajectory dist. (left), (right) (mm): path of the real tip in the world, not of the "
        "device's handle nor of the simulated tip";
    return whole;
  }();
  return d;
}

const CheckpointDefinition& phaseDefinition() {
  static const CheckpointDefinition d = [] {
    return inPhases(inMillimetres(
        motionDefinition("phase-path-length", "Path length of the instrument's tip in the phase", "m", Direction::lower,
                         "L as in path-length, over pairs of points that both lie in the phase")));
  }();
  return d;
}

Measured measure(const Motion& motion) { return Measured::of(pathLength(motion)); }

}  // namespace

CheckpointEntry pathLengthEntry() {
  return {definition(), [](const AttemptContext&) { return perHand(definition(), measure); }};
}

CheckpointEntry phasePathLengthEntry() {
  return {phaseDefinition(),
          [](const AttemptContext& context) { return perHandAndPhase(phaseDefinition(), measure, context); }};
}

}  // namespace calot::analytics
