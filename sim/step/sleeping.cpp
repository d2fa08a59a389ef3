// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/sleeping.h"

#include <algorithm>

#include "sim/step/contact_problem.h"
#include "sim/step/vessel_contacts.h"

namespace calot {

namespace {

/// Before a body sleeps: half a second. Larger: rests cost time; smaller: slow swings are frozen at their ends.
/// Assumed.
constexpr std::uint32_t quietSteps = 50;
constexpr double quietSpeed = 1e-5;   ///< below, a body counts as quiet (m/s): 5 um in the half second. Assumed
constexpr double wakingForce = 1e-3;  ///< of one organ on another (N). Assumed: below what a hand can feel

/// Bodies that are tied together are awake together.
void wakeTied(const Model& model, const Bodies& bodies, const State& state, std::vector<bool>& awake) {
  bool changed = true;
  while (changed) {
    changed = false;
    for (std::size_t c = 0; c < model.connective().size(); ++c) {
      const ConnectiveModel& tie = model.connective()[c];
      if (awake[tie.a] == awake[tie.b] || !holdsAnything(state.connective[c])) continue;
      awake[tie.a] = awake[tie.b] = true;
      changed = true;
    }
    for (const Tie& tie : model.ties()) {
      if (awake[tie.body[0]] == awake[tie.body[1]] || !(bodies.shareLeft(tie) > 0.0)) continue;
      awake[tie.body[0]] = awake[tie.body[1]] = true;
      changed = true;
    }
  }
}

/// Wakes the sleeping one of two structures that press on each other if the other moves: two that rest against
/// each other fall asleep together.
void wakePressed(const Model& model, const Bodies& bodies, std::uint64_t pair, State& state) {
  const auto [a, b] = structuresOfPair(model, pair);
  if (a >= model.structures().size() || b >= model.structures().size()) return;  // a damaged State
  std::uint32_t& one = bodies[model.structures()[a].body].quietSteps(state);
  std::uint32_t& two = bodies[model.structures()[b].body].quietSteps(state);
  if (one >= quietSteps && two == 0) one = 0;
  if (two >= quietSteps && one == 0) two = 0;
}

}  // namespace

void wakeBodies(const Model& model, Bodies& bodies, const InstrumentTravels& travels,
                std::span<const ContactBlock> blocks, State& state, Activity& activity) {
  for (const ContactBlock& block : blocks) {
    if (block.isClash()) continue;
    const double approach = block.tool[0].dot(travels[block.hand].stretch);
    if (block.kind == BlockKind::bilateral || block.gap[0] + std::min(approach, 0.0) < openGap) {
      bodies[block.body].quietSteps(state) = 0;
    }
  }
  for (std::size_t i = 0; i < state.tissue.key.size(); ++i) {
    const std::uint64_t pair = state.tissue.key[i] >> 40U;
    if (!(state.tissue.force[i] > wakingForce)) continue;
    if (pair >= model.tissuePairs().size()) {
      wakePressed(model, bodies, pair, state);
      continue;
    }
    state.organ[model.tissuePairs()[pair].a].quietSteps = 0;
    state.organ[model.tissuePairs()[pair].b].quietSteps = 0;
  }
  for (std::size_t r = 0; r < model.retractions().size(); ++r) {
    const double time = static_cast<double>(state.clock.step) * bodies.step();
    if (isMoving(state.retraction, r, time)) state.organ[model.retractions()[r].organ].quietSteps = 0;
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    activity.awake[b] = !(model.scene().solver.sleeping && bodies[b].quietSteps(state) >= quietSteps);
  }
  wakeTied(model, bodies, state, activity.awake);
  activity.written = activity.awake;
}

void countQuietSteps(const Model& model, Bodies& bodies, std::span<const ContactBlock> blocks, std::size_t which,
                     double speed, State& state) {
  bool touched = false;
  for (const ContactBlock& block : blocks) {
    touched = touched || (!block.isTissueOnTissue() && block.body == which);
  }
  std::uint32_t& quiet = bodies[which].quietSteps(state);
  quiet = !touched && speed < quietSpeed ? quiet + 1 : 0;
  if (model.scene().solver.sleeping && quiet >= quietSteps) bodies[which].stop(state);
}

}  // namespace calot
