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

/// An energised hook's way through a step.
struct HookSweep {
  std::vector<MovingCapsule> electrode;  ///< what carries current; empty: no current
  double pace = 1.0;                     ///< at which it divides tissue, of that of the cutting current
  double charring = 1.0;                 ///< char in the same time, of that by the coagulating current
  std::vector<std::uint8_t> piece;       ///< number of each capsule of the electrode
  std::size_t hand = 0;                  ///< that holds it

  [[nodiscard]] bool energised() const { return !electrode.empty(); }
};

/// Per hand. With both pedals pressed the current is the cutting one.
using HookSweeps = std::array<HookSweep, handCount>;

void sweepHooks(const Model& model, const InstrumentTravels& travels, const State& state, HookSweeps& sweeps);

}  // namespace calot
