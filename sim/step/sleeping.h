// SPDX-License-Identifier: GPL-3.0-or-later
// Selection of the bodies that a step solves: a body that nothing touches and nothing moves sleeps. Internal to this
// folder.
#pragma once

#include "sim/step/bodies.h"
#include "sim/step/contact_block.h"

namespace calot {

/// Wakes the bodies that an instrument is about to touch or grasps, those that another organ pressed in the last step,
/// those that an assistant pulls, and everything tied to them.
/// Reads: instrument blocks, travels, last forces. Writes: sleep counters of State, `activity.awake` and `written`.
void wakeBodies(const Model& model, Bodies& bodies, const InstrumentTravels& travels,
                std::span<const ContactBlock> blocks, State& state, Activity& activity);

/// Counts the steps that a body has been quiet, and stops it where that is long enough. @param speed largest (m/s)
void countQuietSteps(const Model& model, Bodies& bodies, std::span<const ContactBlock> blocks, std::size_t which,
                     double speed, State& state);

}  // namespace calot
