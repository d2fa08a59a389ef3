// SPDX-License-Identifier: GPL-3.0-or-later
// The way of an energised hook through a step. Internal to this folder.
#pragma once

#include <array>
#include <vector>

#include "sim/connective/connective_tissue.h"
#include "sim/scene/model.h"
#include "sim/scene/state.h"
#include "sim/step/contact_block.h"

namespace calot {

/// Per hand: the hook's capsules at the step's beginning and end; none where it carries no current.
using HookSweeps = std::array<std::vector<HookSweep>, handCount>;

void sweepHooks(const Model& model, const InstrumentTravels& travels, const State& state, HookSweeps& sweeps);

}  // namespace calot
