// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a step that moves bodies without contact, and closes their books.
#include <algorithm>
#include <cmath>

#include "sim/scene/stepper_workspace.h"
#include "sim/vessel/clips.h"

namespace calot {

using namespace stepping;

namespace {

constexpr double quietSpeed = 1e-5;   ///< m/s
constexpr double wakingForce = 1e-3;  ///< of one organ on another (N)

}  // namespace

/// Wakes the bodies that an instrument is about to touch or holds, and those that another organ pressed in the last
/// step.
void Stepper::Workspace::wake(State& state) {
  for (const ContactBlock& block : blocks) {
    const double approach = block.tool[0].dot(stretch[block.hand]);
    if (block.kind == BlockKind::ball || block.gap[0] + std::min(approach, 0.0) < slack) {
      body[block.body]->quietSteps(state) = 0;
    }
  }
  for (std::size_t i = 0; i < state.tissue.key.size(); ++i) {
    const std::uint64_t pair = state.tissue.key[i] >> 40U;
    if (!(state.tissue.force[i] > wakingForce) || pair >= model.tissuePairs().size()) continue;
    state.organ[model.tissuePairs()[pair].a].quietSteps = 0;
    state.organ[model.tissuePairs()[pair].b].quietSteps = 0;
  }
  for (std::size_t r = 0; r < model.retractions().size(); ++r) {
    const RetractionDescription& d = model.scene().retraction[r];
    const double time = static_cast<double>(state.clock.step) * settings.step;
    if (time >= d.start && time < d.start + d.duration) state.organ[model.retractions()[r].organ].quietSteps = 0;
  }
  for (std::size_t b = 0; b < body.size(); ++b) {
    moved[b] = !(model.scene().solver.sleeping && body[b]->quietSteps(state) >= quietSteps);
  }
  wakeJoined(state);
  written = moved;
}

std::size_t Stepper::Workspace::firstStructure(std::size_t which) const {
  std::size_t s = 0;
  while (model.structures()[s].body != which) ++s;
  return s;
}

/// What is left of a tie: those of fat go with it.
double Stepper::Workspace::shareLeft(const Tie& tie) const {
  return tie.fat == Tie::none ? 1.0 : fatMotion[tie.fat]->fat().tieShare(tie.fatTie);
}

/// Where an end of a tie is.
Vec3 Stepper::Workspace::endOf(const State& state, const Tie& tie, std::size_t side) const {
  const std::size_t which = tie.body[side];
  const Vec3 place = tie.place[side].of(body[which]->position(state));
  if (side == 1 || tie.offset.isZero(0.0)) return place;
  const BeamState& vessels = state.vessel[which - model.organs().size()];
  return place + vessels.orientation[static_cast<std::size_t>(tie.place[0].node[0])] * tie.offset;
}

/// Sorts ties: vessels that are grown to an organ are solved together with it (a tree that is grown to several, with
/// the first); all other ties are springs that each side feels by itself.
void Stepper::Workspace::coupleTies(double step) {
  std::vector<std::size_t> organOf(body.size(), Tie::none);  // of vessel trees
  std::vector<std::vector<std::size_t>> grown(model.organs().size());
  tiesOf.resize(body.size());
  for (std::size_t t = 0; t < model.ties().size(); ++t) {
    const Tie& tie = model.ties()[t];
    const bool isGrown = tie.fat == Tie::none && tie.body[0] < model.organs().size() &&
                         tie.body[1] >= model.organs().size() && tie.body[1] < firstFat();
    if (isGrown && organOf[tie.body[1]] == Tie::none) organOf[tie.body[1]] = tie.body[0];
    if (isGrown && organOf[tie.body[1]] == tie.body[0]) {
      grown[tie.body[0]].push_back(t);
      continue;
    }
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) tiesOf[tie.body[side]].emplace_back(t, side);
  }
  for (std::size_t o = 0; o < grown.size(); ++o) {
    if (grown[o].empty()) continue;
    std::stable_sort(grown[o].begin(), grown[o].end(),
                     [&](std::size_t a, std::size_t b) { return model.ties()[a].body[1] < model.ties()[b].body[1]; });
    coupling.emplace_back(model, o, grown[o], step);
  }
  solved.assign(body.size(), false);
}

/// Springs between a body and others. Of bodies that have moved already in this step the new velocities count.
void Stepper::Workspace::gatherTies(const State& state, std::size_t which) {
  tieLoads.clear();
  for (const auto& [number, side] : tiesOf[which]) {
    const Tie& tie = model.ties()[number];
    const double share = shareLeft(tie);
    if (!(share > 0.0)) continue;
    const std::size_t other = tie.body[1 - side];
    const std::span<const Vec3> velocity =
        solved[other] && moved[other] ? body[other]->freeVelocity() : body[other]->velocity(state);
    Vec3 target = endOf(state, tie, 1 - side);
    if (side == 0) target -= endOf(state, tie, 0) - tie.place[0].of(body[which]->position(state));
    tieLoads.push_back(
        {tie.place[side], share * tie.stiffness, share * tie.damping, target, tie.place[1 - side].of(velocity)});
  }
}

/// An assistant's springs: their far ends go where they are told, smoothly.
void Stepper::Workspace::gatherRetractions(const State& state, std::size_t organ) {
  const double time = static_cast<double>(state.clock.step) * settings.step;
  for (std::size_t r = 0; r < model.retractions().size(); ++r) {
    const RetractionModel& retraction = model.retractions()[r];
    const RetractionDescription& d = model.scene().retraction[r];
    if (retraction.organ != organ || time < d.start) continue;
    const double s = std::min((time - d.start) / d.duration, 1.0);
    const Vec3 gone = s * s * (3.0 - 2.0 * s) * d.displacement;
    const Vec3 speed = 6.0 * s * (1.0 - s) / d.duration * d.displacement;
    const auto share = 1.0 / static_cast<double>(retraction.node.size());
    for (const int node : retraction.node) {
      SolidPlace place;
      place.node[0] = node;
      place.weight[0] = 1.0;
      place.count = 1;
      const Vec3& rest_ = model.organs()[organ].solid.rest()[static_cast<std::size_t>(node)];
      tieLoads.push_back({place, share * d.stiffness, share * d.damping, rest_ + gone, speed});
    }
  }
}

/// Free motion of all bodies that are awake, under the contact forces that the last step left: vessels, then organs,
/// which take the vessels that are grown to them along, then fat.
void Stepper::Workspace::moveFreely(State& state) {
  std::fill(solved.begin(), solved.end(), false);
  for (std::size_t b = model.organs().size(); b < firstFat(); ++b) moveFreely(state, b);
  for (std::size_t b = 0; b < model.organs().size(); ++b) moveFreely(state, b);
  for (std::size_t b = firstFat(); b < body.size(); ++b) moveFreely(state, b);
}

void Stepper::Workspace::moveFreely(State& state, std::size_t which) {
  const bool isOrgan = which < model.organs().size();
  SolveReport report;
  if (moved[which]) {
    nodal[which].clear();
    addForces(which, carried, 1.0, nodal[which]);
    attachments.clear();
    joints.clear();
    gatherTies(state, which);
    if (isOrgan) {
      gatherAttachments(state, which);
      gatherRetractions(state, which);
      for (TieCoupling& c : coupling) {
        if (c.organ() != which) continue;
        c.begin(state, body);
        joints.push_back(c.joint());
      }
    }
    report = body[which]->freeMotion(state, model.scene().gravity, nodal[which], tieLoads, {attachments, {}, joints});
    for (TieCoupling& c : coupling) {
      if (c.organ() == which) c.pull(body);
    }
    if (!report.converged) {
      result.misses |= miss::solver;
      emit(EventKind::solverMiss, 255, static_cast<std::uint16_t>(firstStructure(which)), Vec3::Zero(),
           report.residual);
    }
  }
  solved[which] = true;
  if (isOrgan) {
    OrganResult& out = result.organ[which];
    out.asleep = !moved[which];
    out.residual = report.residual;
    out.iterations = report.iterations;
  } else if (which >= firstFat()) {
    FatResult& out = result.fat[which - firstFat()];
    out.residual = report.residual;
    out.iterations = report.iterations;
  }
}

/// Wakes a body for the next step.
void Stepper::Workspace::disturb(State& state, std::size_t which) {
  body[which]->quietSteps(state) = 0;
  written[which] = true;
}

/// Counts the steps that a body has been quiet, and stops it where that is long enough.
void Stepper::Workspace::countQuiet(State& state, std::size_t which, double speed) {
  bool touched = false;
  for (const ContactBlock& block : blocks) {
    touched = touched || (block.hand != ContactBlock::nobody && block.body == which);
  }
  std::uint32_t& quiet = body[which]->quietSteps(state);
  quiet = !touched && speed < quietSpeed ? quiet + 1 : 0;
  if (model.scene().solver.sleeping && quiet >= quietSteps) body[which]->stop(state);
}

void Stepper::Workspace::finishOrgans(State& state) {
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    SolidState& organ = state.organ[o];
    OrganResult& out = result.organ[o];
    const OrganModel& fixed = model.organs()[o];
    out.largestSpeed = 0.0;
    if (moved[o]) {
      double speed = 0.0;
      double displacement = 0.0;
      for (std::size_t n = 0; n < organ.position.size(); ++n) {
        speed = std::max(speed, organ.velocity[n].squaredNorm());
        displacement = std::max(displacement, (organ.position[n] - fixed.solid.rest()[n]).squaredNorm());
      }
      out.largestSpeed = std::sqrt(speed);
      organ.largestDisplacement = std::sqrt(displacement);
      organ.volume = fixed.solid.volume(organ.position);
      countQuiet(state, o, out.largestSpeed);
    }
    out.largestDisplacement = organ.largestDisplacement;
    out.volume = organ.volume;
    out.charredArea = state.charred[o].area;
  }
}

void Stepper::Workspace::finishVessels(State& state) {
  for (std::size_t t = 0; t < vesselBody.size(); ++t) {
    const VesselTree& tree = model.vesselTrees()[t];
    BeamState& beams = state.vessel[t];
    const std::size_t b = model.organs().size() + t;
    const VesselBody& own = *vesselBody[t];
    if (moved[b]) {
      double displacement = 0.0;
      for (std::size_t n = 0; n < beams.position.size(); ++n) {
        displacement = std::max(displacement, (beams.position[n] - tree.beams.rest()[n]).squaredNorm());
      }
      beams.largestDisplacement = std::sqrt(displacement);
      countQuiet(state, b, own.report().largestSpeed);
      if (own.report().torn >= 0) {
        const BeamElement& element = tree.beams.elements()[static_cast<std::size_t>(own.report().torn)];
        const std::size_t structure = structureOf(t, static_cast<std::size_t>(element.branch));
        emit(EventKind::vesselTorn, 255, static_cast<std::uint16_t>(structure),
             beams.position[static_cast<std::size_t>(element.a)], own.report().largestStrain);
        tellTear(state, t, static_cast<std::size_t>(own.report().torn));
        disturb(state, b);
        for (std::size_t branch = 0; branch < tree.vessel.size(); ++branch) bounded[structureOf(t, branch)] = false;
      }
    }
    for (std::size_t branch = 0; branch < tree.vessel.size(); ++branch) {
      VesselResult& out = result.vessel[tree.vessel[branch]];
      const BeamModel::Branch& fixed = tree.beams.branches()[branch];
      out.asleep = !moved[b];
      out.largestDisplacement = beams.largestDisplacement;
      out.largestStrain = 0.0;
      out.largestTension = 0.0;
      out.clips = 0;
      out.partings = 0;
      double exposure = 0.0;
      for (std::size_t e = fixed.firstElement; e < fixed.firstElement + fixed.elements(); ++e) {
        if (beams.parting[e] != Parting::none) ++out.partings;
        exposure = std::max(exposure, beams.exposure[e]);
        if (!moved[b]) continue;
        out.largestStrain = std::max(out.largestStrain, own.strain()[e]);
        out.largestTension = std::max(out.largestTension, own.tension()[e]);
      }
      out.charred = exposure / model.scene().vessels[tree.vessel[branch]].burnThrough;
      for (const std::uint32_t clipped : beams.clipBranch) out.clips += clipped == branch ? 1 : 0;
    }
  }
}

/// A torn vessel bleeds or leaks as a cut one does.
void Stepper::Workspace::tellTear(State& state, std::size_t tree, std::size_t torn) {
  const BeamModel& beams = model.vesselTrees()[tree].beams;
  BeamState& vessels = state.vessel[tree];
  const BeamElement& element = beams.elements()[torn];
  const BeamModel::Branch& branch = beams.branches()[static_cast<std::size_t>(element.branch)];
  BeamPlace where;
  where.branch = static_cast<std::size_t>(element.branch);
  where.element = torn;
  where.share = vessels.partedAt[torn];
  where.place = branch.place[torn - branch.firstElement] + where.share * element.length;
  vessels.parting[torn] = Parting::none;  // judged as it was before
  const CutJudgement judged = judgeCut(beams, vessels, where);
  vessels.parting[torn] = Parting::torn;
  if (!judged.opensBefore && !judged.opensAfter) return;
  emit(EventKind::cutOpen, 255, static_cast<std::uint16_t>(structureOf(tree, where.branch)),
       vessels.position[static_cast<std::size_t>(element.a)],
       (judged.opensBefore ? 1.0 : 0.0) + (judged.opensAfter ? 2.0 : 0.0));
}

void Stepper::Workspace::finishFat(State& state) {
  for (std::size_t f = 0; f < fatMotion.size(); ++f) {
    const std::size_t b = firstFat() + f;
    SolidState& solid = state.fat[f].solid;
    FatResult& out = result.fat[f];
    const FatBody& fat = fatMotion[f]->fat();
    const std::vector<Vec3>& rest_ = fat.model().solid().rest();
    out.asleep = !moved[b];
    out.largestSpeed = 0.0;
    if (moved[b]) {
      double speed = 0.0;
      double displacement = 0.0;
      for (std::size_t n = 0; n < rest_.size(); ++n) {
        speed = std::max(speed, solid.velocity[n].squaredNorm());
        displacement = std::max(displacement, (solid.position[n] - rest_[n]).squaredNorm());
      }
      out.largestSpeed = std::sqrt(speed);
      solid.largestDisplacement = std::sqrt(displacement);
      if (!carved[f]) countQuiet(state, b, out.largestSpeed);
    }
    out.largestDisplacement = solid.largestDisplacement;
    out.volume = fat.volume().total();
    out.toClear = fat.model().regions() > 0 ? fat.volume().inRegion(0) : 0.0;
  }
}

/// The guard of last resort: says that the simulation ran away, and where.
void Stepper::Workspace::watchSpeeds(const State& state) {
  for (std::size_t b = 0; b < body.size(); ++b) {
    if (!moved[b]) continue;
    // advance() lets nothing that is not finite into State and stops the node instead; that is no motion either.
    double largest = stopped[b] ? 1e300 : 0.0;
    std::size_t where = 0;
    const std::span<const Vec3> velocity = body[b]->velocity(state);
    for (std::size_t n = 0; n < velocity.size(); ++n) {
      const double speed = velocity[n].norm();
      if (speed <= largest) continue;
      largest = speed;
      where = n;
    }
    if (largest <= fastestMotion) continue;
    result.misses |= miss::runaway;
    emit(EventKind::runaway, 255, static_cast<std::uint16_t>(firstStructure(b)), body[b]->position(state)[where],
         largest);
  }
}

}  // namespace calot
