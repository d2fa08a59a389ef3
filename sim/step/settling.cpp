// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "sim/step/stages.h"
#include "sim/step/tissue_effects.h"

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
void wakePressed(const Model& model, std::uint64_t pair, std::vector<std::uint32_t>& quiet) {
  const auto [a, b] = structuresOfPair(model, pair);
  if (a >= model.structures().size() || b >= model.structures().size()) return;  // a damaged State
  std::uint32_t& one = quiet[model.structures()[a].body];
  std::uint32_t& two = quiet[model.structures()[b].body];
  if (one >= quietSteps && two == 0) one = 0;
  if (two >= quietSteps && one == 0) two = 0;
}

}  // namespace

void wakeBodies(const Model& model, const Bodies& bodies, const InstrumentTravels& travels,
                std::span<const ContactBlock> blocks, const State& state, Activity& activity) {
  std::vector<std::uint32_t>& quiet = activity.quiet;
  for (std::size_t b = 0; b < bodies.size(); ++b) quiet[b] = bodies[b].quietSteps(state);
  for (const ContactBlock& block : blocks) {
    const PushedTool* const tool = block.tool();
    if (tool == nullptr) continue;
    const double approach = tool->row[0].dot(travels[tool->hand].stretch);
    if (block.kind == BlockKind::bilateral || block.gap[0] + std::min(approach, 0.0) < openGap) {
      quiet[block.against()->body] = 0;
    }
  }
  for (std::size_t i = 0; i < state.tissue.key.size(); ++i) {
    const std::uint64_t pair = state.tissue.key[i] >> pairShift;
    if (!(state.tissue.force[i] > wakingForce)) continue;
    if (pair >= model.tissuePairs().size()) {
      wakePressed(model, pair, quiet);
      continue;
    }
    quiet[model.tissuePairs()[pair].a] = 0;
    quiet[model.tissuePairs()[pair].b] = 0;
  }
  for (std::size_t r = 0; r < model.retractions().size(); ++r) {
    const double time = static_cast<double>(state.clock.step) * bodies.step();
    if (isMoving(state.retraction, r, time)) quiet[model.retractions()[r].organ] = 0;
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    activity.awake[b] = !(model.scene().solver.sleeping && quiet[b] >= quietSteps);
  }
  wakeTied(model, bodies, state, activity.awake);
  activity.written = activity.awake;
}

namespace {

/// Below, nothing counts as touching (N). Larger misses light touches; smaller counts rounding. Assumed.
constexpr double minForce = 1e-6;
/// After which instruments that touch again make a new touch (s). Larger: two blows count as one; smaller: one touch
/// that chatters counts as many. Assumed: the hand's reaction takes longer.
constexpr double clashPause = 0.1;

/// Largest speed (m/s) and largest displacement (m) over a body's nodes.
struct Extremes {
  double speed = 0.0;
  double displacement = 0.0;
};
Extremes extremesOf(std::span<const Vec3> position, std::span<const Vec3> velocity, std::span<const Vec3> rest) {
  double speed = 0.0;
  double displacement = 0.0;
  for (std::size_t n = 0; n < rest.size(); ++n) {
    speed = std::max(speed, velocity[n].squaredNorm());
    displacement = std::max(displacement, (position[n] - rest[n]).squaredNorm());
  }
  return {std::sqrt(speed), std::sqrt(displacement)};
}

/// The steps that a body has been quiet, with this one. @param speed largest (m/s)
std::uint32_t countQuiet(std::uint32_t before, std::span<const ContactBlock> blocks, std::size_t body, double speed) {
  const bool touched = std::any_of(blocks.begin(), blocks.end(), [&](const ContactBlock& block) {
    return block.tool() != nullptr && block.against()->body == body;
  });
  return !touched && speed < quietSpeed ? before + 1 : 0;
}

}  // namespace

void Settling::settleOrgans(const ContactSystem& contact, Activity& activity, State& state, StepResult& result) const {
  for (std::size_t o = 0; o < model_.organs().size(); ++o) {
    result.organ[o].maxSpeed = 0.0;
    if (!activity.awake[o]) continue;
    SolidState& organ = state.organ[o];
    const SolidModel& solid = model_.organs()[o].solid;
    const Extremes now = extremesOf(organ.position, organ.velocity, solid.rest());
    result.organ[o].maxSpeed = now.speed;
    organ.maxDisplacement = now.displacement;
    organ.volume = solid.volume(organ.position);
    activity.quiet[o] = countQuiet(activity.quiet[o], contact.blocks, o, now.speed);
  }
}

/// Stops what has been quiet for long enough.
void Settling::stopQuiet(std::size_t body, Bodies& bodies, const Activity& activity, State& state) const {
  if (model_.scene().solver.sleeping && activity.quiet[body] >= quietSteps) bodies[body].stop(state);
}

void Settling::settleVessels(const ContactSystem& contact, Bodies& bodies, Activity& activity, State& state,
                             StepLog& log) const {
  for (std::size_t t = 0; t < model_.vesselTrees().size(); ++t) {
    const std::size_t b = model_.organs().size() + t;
    if (!activity.awake[b]) continue;
    const BeamModel& model = model_.vesselTrees()[t].beams;
    BeamState& beams = state.vessel[t];
    const BeamReport& report = bodies.vessel(t).report();
    beams.maxDisplacement = extremesOf(beams.position, beams.velocity, model.rest()).displacement;
    activity.quiet[b] = countQuiet(activity.quiet[b], contact.blocks, b, report.maxSpeed);
    if (report.torn < 0) continue;
    stopQuiet(b, bodies, activity, state);  // before the tear wakes it
    const auto torn = static_cast<std::size_t>(report.torn);
    const BeamElement& element = model.elements()[torn];
    log.emit(EventKind::vesselTorn, StepLog::noHand,
             bodies.structureOfVessel(t, static_cast<std::size_t>(element.branch)),
             beams.position[static_cast<std::size_t>(element.a)], report.maxStrain);
    reportTear(model_, t, torn, state, log);
    activity.reshape(b);
  }
}

void Settling::settleFat(const ContactSystem& contact, const Bodies& bodies, Activity& activity, State& state,
                         StepResult& result) const {
  for (std::size_t f = 0; f < bodies.fatCount(); ++f) {
    const std::size_t b = bodies.firstFat() + f;
    result.fat[f].maxSpeed = 0.0;
    if (!activity.awake[b]) continue;
    SolidState& solid = state.fat[f].solid;
    const Extremes now = extremesOf(solid.position, solid.velocity, bodies.fat(f).fat().model().solid().rest());
    result.fat[f].maxSpeed = now.speed;
    solid.maxDisplacement = now.displacement;
    if (!activity.carved[f]) activity.quiet[b] = countQuiet(activity.quiet[b], contact.blocks, b, now.speed);
  }
}

void Settling::rest(Surfaces& surfaces, Bodies& bodies, const Activity& activity, State& state) const {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    bodies[b].quietSteps(state) = activity.quiet[b];
    if (activity.awake[b]) stopQuiet(b, bodies, activity, state);
    if (activity.reshaped[b]) surfaces.markBodyStale(b);
  }
}

void Settling::settleTouches(const ContactSystem& contact, std::size_t h, State& state, HandResult& out,
                             StepLog& log) const {
  TouchState& touches = state.hand[h].touches;
  const Vec3& tip = state.hand[h].instrument.position;
  std::fill(out.structureForce.begin(), out.structureForce.end(), 0.0);
  for (const ContactBlock& block : contact.blocks) {
    const auto* touch = block.as<ToolOnTissue>();
    if (touch != nullptr && touch->tool.hand == h) out.structureForce[touch->structure] += contact.lambda[block.row];
  }
  out.touching = 0;
  for (std::size_t s = 0; s < model_.structures().size(); ++s) {
    const std::uint32_t bit = 1U << s;
    const bool touched = (touches.structures & bit) != 0;
    const bool now = out.structureForce[s] > minForce;
    if (now) out.touching |= bit;
    if (now && !touched) {
      touches.since[s] = state.clock.step;
      log.emit(EventKind::contactBegin, h, s, tip, out.structureForce[s]);
    } else if (touched && !now) {
      log.emit(EventKind::contactEnd, h, s, tip,
               static_cast<double>(state.clock.step - touches.since[s]) * model_.stepSeconds());
    }
  }
  touches.structures = out.touching;
}

/// One touch is one event: contact that is interrupted for less than clashPause goes on.
void Settling::settleClash(const ContactSystem& contact, State& state, ContactResult& result, StepLog& log) const {
  InstrumentTouchState& touch = state.instruments;
  const ContactBlock* strongest = nullptr;
  for (const ContactBlock& block : contact.blocks) {
    if (block.as<ToolOnTool>() == nullptr || !(contact.lambda[block.row] > minForce)) continue;
    if (strongest == nullptr || contact.lambda[block.row] > contact.lambda[strongest->row]) strongest = &block;
  }
  result.instrumentsTouch = strongest != nullptr;
  if (strongest == nullptr) {
    const double pause = static_cast<double>(state.clock.step - touch.last) * model_.stepSeconds();
    touch.touching = touch.touching && pause < clashPause;
    return;
  }
  touch.last = state.clock.step;
  if (touch.touching) return;
  touch.touching = true;
  touch.begun = state.clock.step;
  log.emit(EventKind::instrumentsTouched, StepLog::noHand, 0, strongest->as<ToolOnTool>()->where,
           contact.lambda[strongest->row]);
}

void Settling::reportRunaway(const Bodies& bodies, const Activity& activity, const std::vector<bool>& diverged,
                             const State& state, StepLog& log) const {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!activity.awake[b]) continue;
    // Body::advance() lets nothing that is not finite into State and stops the node instead; that is no motion either.
    double largest = diverged[b] ? 1e300 : 0.0;
    std::size_t where = 0;
    const std::span<const Vec3> velocity = bodies[b].velocity(state);
    for (std::size_t n = 0; n < velocity.size(); ++n) {
      const double speed = velocity[n].norm();
      if (speed <= largest) continue;
      largest = speed;
      where = n;
    }
    if (largest <= maxTissueSpeed) continue;
    log.miss(miss::runaway);
    log.emit(EventKind::runaway, StepLog::noHand, bodies.firstStructure(b), bodies[b].position(state)[where], largest);
  }
}

void Settling::run(const ContactSystem& contact, const std::vector<bool>& diverged, Surfaces& surfaces, Bodies& bodies,
                   State& state, Activity& activity, StepResult& result, StepLog& log) {
  settleOrgans(contact, activity, state, result);
  settleVessels(contact, bodies, activity, state, log);
  settleFat(contact, bodies, activity, state, result);
  rest(surfaces, bodies, activity, state);
  hold_.run(bodies, activity, state, result);
  grasping_.settle(surfaces, state, activity, result, log);
  for (std::size_t h = 0; h < handCount; ++h) settleTouches(contact, h, state, result.hand[h], log);
  settleClash(contact, state, result.contact, log);
  reportRunaway(bodies, activity, diverged, state, log);
}

}  // namespace calot
