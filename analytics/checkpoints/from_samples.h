// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/motion.h"
#include "recorder/sources/tracked_motion.h"

namespace calot::analytics {

/// What a file of motion doesn't say of itself.
struct SamplesContext {
  recorder::Outcome outcome = recorder::Outcome::stopped;
  std::string handedness = "unknown";
  double cutoff = motionCutoff;  ///< Hz; values that are stored are of the default
};

/// The motion of one hand: every row is a sample.
Motion motionOf(const recorder::TrackedMotion& tracked, std::size_t hand, double cutoff = motionCutoff);

/// The figures that motion alone can give (those whose definition allows the origin `samples`), in the registry's
/// order. The attempt lasts from the first row to the last.
std::vector<CheckpointValue> valuesFromSamples(const recorder::TrackedMotion& tracked, const SamplesContext& context);

}  // namespace calot::analytics
