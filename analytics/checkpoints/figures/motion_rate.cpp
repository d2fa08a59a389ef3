// SPDX-License-Identifier: GPL-3.0-or-later
// How fast the tracker really measured: what the other figures of motion must be read with.
#include "analytics/checkpoints/checkpoint.h"

#include "analytics/checkpoints/hand_motion.h"

namespace calot::analytics {
namespace {

const CheckpointDefinition& motionRateDefinition() {
  static const CheckpointDefinition d = [] {
    CheckpointDefinition rate =
        motionDefinition("motion-rate", "Effective rate of the tracker", "Hz", Direction::none,
                         "1 / mean of the intervals between samples that are at most 0.1 s and at most 1.5 times their "
                         "median; a sample is a "
                         "measured tick whose pose differs from the one before, or a row of a kinematics file");
    rate.filter = "none";
    rate.finality = Finality::running;
    return rate;
  }();
  return d;
}

Measured motionRateOf(const Motion& motion) {
  if (motion.rate == 0.0) return Measured::notApplicable("the pose never changed");
  return Measured::of(motion.rate);
}

}  // namespace

std::vector<CheckpointEntry> motionRateEntries() {
  return {{{CheckpointFamily::motion, 170}, motionRateDefinition(), [](const AttemptContext&) {
             return perHand(motionRateDefinition(), motionRateOf);
           }}};
}

}  // namespace calot::analytics
