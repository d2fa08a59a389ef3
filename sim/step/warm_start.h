// SPDX-License-Identifier: GPL-3.0-or-later
// Contact forces from step to step: the warm start of the contact problem. Internal to this folder.
#pragma once

#include "sim/scene/state.h"
#include "sim/step/contact_block.h"

namespace calot {

/// Numbers the rows and looks up the forces of the last step at the same contact points, projected onto what each block
/// admits: `carried` and `lambda`.
void loadWarmStart(const State& state, ContactSystem& contact);

/// Stores the forces by contact point for the next step.
void storeWarmStart(const ContactSystem& contact, State& state);

}  // namespace calot
