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
                         "intervals between samples by the time that they fill, those over 1.5 of the tracker's own "
                         "intervals left out (in a file of motion: over 2.5); a sample is a measured tick whose pose "
                         "differs from the one before, or a row of the file");
    rate.filter = "none";
    rate.minCoverage = 0.0;
    rate.finality = Finality::running;
    rate.notOutcome = "it describes the tracker";
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
