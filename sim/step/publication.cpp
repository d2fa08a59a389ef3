// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/stages.h"

#include <algorithm>
#include <cmath>

#include "sim/step/tissue_contacts.h"
#include "sim/step/tissue_effects.h"

namespace calot {

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

/// Share of the area of some strands that is attached; 0 of none.
double attachedShare(const ConnectiveTissue& tissue, const ConnectiveState& state,
                     std::span<const std::uint32_t> strands) {
  double all = 0.0;
  double attached = 0.0;
  for (const std::uint32_t s : strands) {
    const double area = tissue.strands()[s].area;
    all += area;
    if (state.condition[s] == StrandCondition::attached) attached += area;
  }
  return all > 0.0 ? attached / all : 0.0;
}

}  // namespace

Publication::Publication(const Model& model, Grasping& grasping, const Bodies& bodies)
    : model_(model), grasping_(grasping) {
  for (std::size_t f = 0; f < bodies.fatCount(); ++f) {
    const FatBody& fat = bodies.fat(f).fat();
    std::vector<double>& whole = wholeRegion_.emplace_back();
    for (std::size_t r = 0; r < fat.model().regions(); ++r) whole.push_back(fat.volume().inRegion(r));
  }
}

/// Share that is left of the fat in a region.
double Publication::shareLeft(const Bodies& bodies, std::size_t fat, std::size_t region) const {
  const double whole = wholeRegion_[fat][region];
  return whole > 0.0 ? bodies.fat(fat).fat().volume().inRegion(region) / whole : 0.0;
}

void Publication::publishConnective(const State& state, StepResult& result) const {
  for (std::size_t c = 0; c < model_.connective().size(); ++c) {
    const ConnectiveModel& fixed = model_.connective()[c];
    ConnectiveResult& out = result.connective[c];
    out.lowerAttached = attachedShare(fixed.tissue, state.connective[c], fixed.third[0]);
    out.middleAttached = attachedShare(fixed.tissue, state.connective[c], fixed.third[1]);
    out.upperAttached = attachedShare(fixed.tissue, state.connective[c], fixed.third[2]);
  }
}

void Publication::publishOrgans(const ContactSystem& contact, Bodies& bodies, const Activity& activity, State& state,
                                StepResult& result) const {
  for (std::size_t o = 0; o < model_.organs().size(); ++o) {
    SolidState& organ = state.organ[o];
    OrganResult& out = result.organ[o];
    const OrganModel& fixed = model_.organs()[o];
    out.maxSpeed = 0.0;
    if (activity.awake[o]) {
      const Extremes now = extremesOf(organ.position, organ.velocity, fixed.solid.rest());
      out.maxSpeed = now.speed;
      organ.maxDisplacement = now.displacement;
      organ.volume = fixed.solid.volume(organ.position);
      countQuietSteps(model_, bodies, contact.blocks, o, now.speed, state);
    }
    out.maxDisplacement = organ.maxDisplacement;
    out.volume = organ.volume;
    const CharState& charred = state.charred[o];
    out.charredArea = charred.area;
    out.wallExposure = charred.maxExposure;
  }
}

void Publication::publishVessel(const Bodies& bodies, bool awake, const State& state, std::size_t tree,
                                std::size_t branch, VesselResult& out) const {
  const VesselTree& vessels = model_.vesselTrees()[tree];
  const BeamState& beams = state.vessel[tree];
  const BeamModel::Branch& fixed = vessels.beams.branches()[branch];
  out.asleep = !awake;
  out.maxDisplacement = beams.maxDisplacement;
  out.maxStrain = 0.0;
  out.maxTension = 0.0;
  out.clips = 0;
  out.partings = 0;
  double exposure = 0.0;
  for (std::size_t e = fixed.firstElement; e < fixed.firstElement + fixed.elements(); ++e) {
    if (beams.parting[e] != Parting::none) ++out.partings;
    if (!awake) continue;
    out.maxStrain = std::max(out.maxStrain, bodies.vessel(tree).strain()[e]);
    out.maxTension = std::max(out.maxTension, bodies.vessel(tree).tension()[e]);
  }
  const double through = model_.scene().vessels[vessels.vessel[branch]].burnThrough;
  const double injured = model_.scene().cautery.injury * through;
  std::size_t stations = 0;
  for (std::size_t s = fixed.firstStation; s < fixed.firstStation + fixed.stations; ++s) {
    exposure = std::max(exposure, beams.exposure[s]);
    if (beams.exposure[s] >= injured) ++stations;
  }
  out.charred = exposure / through;
  out.injured = static_cast<double>(stations) * fixed.spacing();
  for (const std::uint32_t clipped : beams.clipBranch) out.clips += clipped == branch ? 1 : 0;
}

void Publication::publishVessels(const ContactSystem& contact, Surfaces& surfaces, Bodies& bodies, Activity& activity,
                                 State& state, StepResult& result, StepLog& log) const {
  for (std::size_t t = 0; t < model_.vesselTrees().size(); ++t) {
    const VesselTree& tree = model_.vesselTrees()[t];
    BeamState& beams = state.vessel[t];
    const std::size_t b = model_.organs().size() + t;
    const BeamReport& report = bodies.vessel(t).report();
    if (activity.awake[b]) {
      double displacement = 0.0;
      for (std::size_t n = 0; n < beams.position.size(); ++n) {
        displacement = std::max(displacement, (beams.position[n] - tree.beams.rest()[n]).squaredNorm());
      }
      beams.maxDisplacement = std::sqrt(displacement);
      countQuietSteps(model_, bodies, contact.blocks, b, report.maxSpeed, state);
      if (report.torn >= 0) {
        const auto torn = static_cast<std::size_t>(report.torn);
        const BeamElement& element = tree.beams.elements()[torn];
        log.emit(EventKind::vesselTorn, StepLog::noHand,
                 bodies.structureOfVessel(t, static_cast<std::size_t>(element.branch)),
                 beams.position[static_cast<std::size_t>(element.a)], report.maxStrain);
        reportTear(model_, t, torn, state, log);
        activity.disturb(bodies, state, b);
        surfaces.markBodyStale(b);
      }
    }
    for (std::size_t branch = 0; branch < tree.vessel.size(); ++branch) {
      publishVessel(bodies, activity.awake[b], state, t, branch, result.vessel[tree.vessel[branch]]);
    }
  }
}

void Publication::publishFat(const ContactSystem& contact, Bodies& bodies, const Activity& activity, State& state,
                             StepResult& result) const {
  for (std::size_t f = 0; f < bodies.fatCount(); ++f) {
    const std::size_t b = bodies.firstFat() + f;
    SolidState& solid = state.fat[f].solid;
    FatResult& out = result.fat[f];
    const FatBody& fat = bodies.fat(f).fat();
    out.asleep = !activity.awake[b];
    out.maxSpeed = 0.0;
    if (activity.awake[b]) {
      const Extremes now = extremesOf(solid.position, solid.velocity, fat.model().solid().rest());
      out.maxSpeed = now.speed;
      solid.maxDisplacement = now.displacement;
      if (!activity.carved[f]) countQuietSteps(model_, bodies, contact.blocks, b, now.speed, state);
    }
    out.maxDisplacement = solid.maxDisplacement;
    out.volume = fat.volume().total();
    const bool clears = model_.scene().fat[f].triangleDepth > 0.0;
    out.toClear = clears ? fat.volume().inRegion(FatTissue::regionToClear) : 0.0;
    out.uncleared = clears ? shareLeft(bodies, f, FatTissue::regionToClear) : 0.0;
  }
  for (const VesselCover& cover : model_.covers())
    result.vessel[cover.vessel].covered = shareLeft(bodies, cover.fat, cover.region);
}

void Publication::publishHand(const ContactSystem& contact, std::size_t h, State& state, HandResult& out,
                              StepLog& log) const {
  HandState& hand = state.hand[h];
  out.instrument = hand.instrument;
  out.tipReal = hand.realPosition;
  out.tipSimulated = hand.simulatedPosition;
  out.orientation = hand.simulatedOrientation;
  out.jaw = hand.jaw;
  out.clips = hand.clips;
  out.insertion = (hand.simulatedPosition - model_.scene().hands[h].port).norm();
  std::fill(out.structureForce.begin(), out.structureForce.end(), 0.0);
  for (const ContactBlock& block : contact.blocks) {
    const auto* touch = block.as<ToolOnTissue>();
    if (touch != nullptr && touch->tool.hand == h) out.structureForce[touch->structure] += contact.lambda[block.row];
  }
  out.touching = 0;
  for (std::size_t s = 0; s < model_.structures().size(); ++s) {
    const std::uint32_t bit = 1U << s;
    const bool touched = (hand.touching & bit) != 0;
    const bool now = out.structureForce[s] > minForce;
    if (now) out.touching |= bit;
    if (now && !touched) {
      hand.touchingSince[s] = state.clock.step;
      log.emit(EventKind::contactBegin, h, s, hand.simulatedPosition, out.structureForce[s]);
    } else if (touched && !now) {
      log.emit(EventKind::contactEnd, h, s, hand.simulatedPosition,
               static_cast<double>(state.clock.step - hand.touchingSince[s]) * model_.stepSeconds());
    }
  }
  hand.touching = out.touching;
}

/// One touch is one event: contact that is interrupted for less than clashPause goes on.
void Publication::publishClash(const ContactSystem& contact, State& state, StepResult& result, StepLog& log) const {
  InstrumentTouchState& touch = state.instruments;
  const ContactBlock* strongest = nullptr;
  for (const ContactBlock& block : contact.blocks) {
    if (block.as<ToolOnTool>() == nullptr || !(contact.lambda[block.row] > minForce)) continue;
    if (strongest == nullptr || contact.lambda[block.row] > contact.lambda[strongest->row]) strongest = &block;
  }
  result.contact.instrumentsTouch = strongest != nullptr;
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

void Publication::reportRunaway(const Bodies& bodies, const Activity& activity, const std::vector<bool>& diverged,
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

void Publication::run(const ContactSystem& contact, Surfaces& surfaces, Bodies& bodies, State& state,
                      Activity& activity, StepResult& result, StepLog& log) {
  publishOrgans(contact, bodies, activity, state, result);
  publishConnective(state, result);
  publishVessels(contact, surfaces, bodies, activity, state, result, log);
  publishFat(contact, bodies, activity, state, result);
  grasping_.settle(surfaces, state, activity, result, log);
  for (std::size_t h = 0; h < handCount; ++h) publishHand(contact, h, state, result.hand[h], log);
  publishClash(contact, state, result, log);
}

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
    const PushedTool* const tool = block.tool();
    if (tool == nullptr) continue;
    const double approach = tool->row[0].dot(travels[tool->hand].stretch);
    if (block.kind == BlockKind::bilateral || block.gap[0] + std::min(approach, 0.0) < openGap) {
      bodies[block.against()->body].quietSteps(state) = 0;
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
    touched = touched || (block.tool() != nullptr && block.against()->body == which);
  }
  std::uint32_t& quiet = bodies[which].quietSteps(state);
  quiet = !touched && speed < quietSpeed ? quiet + 1 : 0;
  if (model.scene().solver.sleeping && quiet >= quietSteps) bodies[which].stop(state);
}

}  // namespace calot
