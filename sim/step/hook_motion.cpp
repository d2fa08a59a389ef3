// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/hook_motion.h"

#include "sim/step/placed_instrument.h"

namespace calot {

void sweepHooks(const Model& model, const InstrumentTravels& travels, const State& state, HookSweeps& sweeps) {
  for (std::size_t hand = 0; hand < handCount; ++hand) {
    HookSweep& sweep = sweeps[hand];
    sweep.electrode.clear();
    sweep.piece.clear();
    sweep.hand = hand;
    const HandState& h = state.hand[hand];
    const CauteryDescription& cautery = model.scene().cautery;
    sweep.pace = currentPace(cautery, h);
    if (!(sweep.pace > 0.0)) continue;
    sweep.charring = (h.buttons & button::cutPedal) != 0 ? cautery.cutChar : 1.0;
    const HandDescription& description = model.scene().hands[hand];
    const Pose now = simulatedPose(h);
    const InstrumentShape hook =
        instrumentShape(h.instrument, h.jaw, description.shaftRadius, (now.position - description.port).norm());
    const InstrumentShape before = placed(hook, travels[hand].before);
    const InstrumentShape after = placed(hook, now);
    for (std::size_t k = 0; k < after.capsules().size(); ++k) {
      const Capsule& from = before.capsules()[k];
      const Capsule& to = after.capsules()[k];
      if (to.part != Capsule::Part::electrode) continue;
      sweep.electrode.push_back({{from.p0, from.p1}, {to.p0, to.p1}, to.radius});
      sweep.piece.push_back(to.piece);
    }
  }
}

}  // namespace calot
