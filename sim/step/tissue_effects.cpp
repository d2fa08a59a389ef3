// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/step/tissue_effects.h"

#include <algorithm>
#include <cmath>

#include "sim/vessel/beam_state.h"

namespace calot {

namespace {

/// Energy of one touch after which its smoke is reported (J). Larger: fewer, later events. Assumed: half a second of 30
/// W.
constexpr double smokePortion = 15.0;

/// Tissue nearer to a parting than this is burned with it and is not parted once more (m). Larger: a second burn
/// close by is lost; smaller: one burn leaves crumbs. Assumed: a little more than the wire's reach.
constexpr double stumpsEnd = 0.002;

bool isStumpsEnd(const BeamModel::Branch& branch, const BeamState& vessels, double arcLength) {
  for (std::size_t i = 0; i < branch.elements(); ++i) {
    const std::size_t e = branch.firstElement + i;
    if (vessels.parting[e] == Parting::none) continue;
    const double parted = branch.arcLength[i] + vessels.partedAt[e] * (branch.arcLength[i + 1] - branch.arcLength[i]);
    if (std::abs(arcLength - parted) < stumpsEnd) return true;
  }
  return false;
}

bool isInjured(const BeamModel::Branch& branch, const BeamState& vessels, double exposure) {
  const double* const first = vessels.exposure.data() + branch.firstStation;
  return std::any_of(first, first + branch.stations, [exposure](double e) { return e >= exposure; });
}

/// Smoke is reported in portions of a touch, and when it ends. @param source structure, or noStructure: no touch
void emitSmoke(std::size_t hand, std::uint32_t source, double energy, State& state, StepLog& log) {
  BurnState& burn = state.hand[hand].burn;
  const auto emit = [&] {
    if (burn.energy > 0.0)
      log.emit(EventKind::smoke, hand, burn.tissue, state.hand[hand].instrument.position, burn.energy);
    burn.energy = 0.0;
  };
  if (source != burn.tissue) emit();
  burn.tissue = source;
  burn.energy += energy;
  if (burn.energy >= smokePortion) emit();
}

}  // namespace

/// The source that smoke is reported of, among all touched: connective tissue, fat, then structures in their order.
std::uint32_t CauteryEffects::firstTouched(const HookTouches& touches, const Bodies& bodies) {
  for (std::size_t c = 0; c < touches.strand.size(); ++c) {
    if (!touches.strand[c].empty()) return static_cast<std::uint32_t>(smokeOfConnective + c);
  }
  for (std::size_t f = 0; f < touches.fat.size(); ++f) {
    if (touches.fat[f] > 0.0) return static_cast<std::uint32_t>(bodies.structureOfFat(f));
  }
  if (!touches.cell.empty()) return touches.cell.front().structure;
  return touches.station.empty() ? noStructure : touches.station.front().structure;
}

void CauteryEffects::charOrgans(const HookTouches& touches, const Dose& dose, const Surfaces& surfaces, State& state,
                                Activity& activity, StepLog& log) const {
  const double charTime = model_.scene().cautery.charTime;
  for (const HookTouches::Cell& touch : touches.cell) {
    const std::size_t o = model_.structures()[touch.structure].index;
    const OrganModel& organ = model_.organs()[o];
    CharState& burns = state.charred[o];
    activity.charred[o] = true;
    const std::size_t cells = std::size_t{organ.division[touch.triangle]} * organ.division[touch.triangle];
    const auto known = std::find(burns.triangle.begin(), burns.triangle.end(), touch.triangle);
    const auto k = static_cast<std::size_t>(known - burns.triangle.begin());
    if (known == burns.triangle.end()) {
      burns.triangle.push_back(touch.triangle);
      burns.firstCell.push_back(static_cast<std::uint32_t>(burns.exposure.size()));
      burns.exposure.resize(burns.exposure.size() + cells, 0.0F);
      burns.charring.resize(burns.exposure.size(), 0.0F);
    }
    const std::size_t cell = burns.firstCell[k] + touch.cell;
    const double before = burns.charring[cell];
    const double charring = before + touch.share * dose.charring;
    burns.charring[cell] = static_cast<float>(charring);
    burns.area += organ.triangleArea[touch.triangle] / static_cast<double>(cells) *
                  (std::min(charring / charTime, 1.0) - std::min(before / charTime, 1.0));
    const double exposure = burns.exposure[cell] + touch.share * dose.wall;
    burns.exposure[cell] = static_cast<float>(exposure);
    burns.maxExposure = std::max(burns.maxExposure, exposure);
    const double through = model_.scene().organs[o].burnThrough;
    if (through > 0.0 && exposure >= through) {
      const int corner = organ.surface.triangles()[touch.triangle][0];
      perforateOrgan(model_, o, surfaces.points(touch.structure)[static_cast<std::size_t>(corner)], exposure, state,
                     activity, log);
    }
  }
}

void CauteryEffects::burnVessels(const HookTouches& touches, const Dose& dose, std::size_t hand, State& state,
                                 Activity& activity, StepLog& log) const {
  for (const HookTouches::Station& touch : touches.station) {
    const StructureModel& s = model_.structures()[touch.structure];
    const VesselTree& tree = model_.vesselTrees()[s.index];
    const BeamModel::Branch& branch = tree.beams.branches()[s.branch];
    BeamState& vessels = state.vessel[s.index];
    const BeamPoint where = pointAt(tree.beams, s.branch, branch.arcLengthOf(touch.station));
    if (vessels.parting[where.element] != Parting::none) continue;
    double& exposure = vessels.exposure[branch.firstStation + touch.station];
    double& charring = vessels.charring[branch.firstStation + touch.station];
    const double through = model_.scene().vessels[tree.vessel[s.branch]].burnThrough;
    const double injured = model_.scene().cautery.injury * through;
    const bool isNew =
        exposure < injured && exposure + touch.share * dose.wall >= injured && !isInjured(branch, vessels, injured);
    exposure += touch.share * dose.wall;
    charring += touch.share * dose.charring;
    activity.disturb(s.body);
    if (isNew) {
      log.emit(EventKind::wallInjured, hand, touch.structure, centreLine(tree.beams, vessels, where).position,
               where.arcLength);
    }
    if (exposure >= through && !isStumpsEnd(branch, vessels, where.arcLength)) {
      partVessel(model_, touch.structure, where, EventKind::vesselBurned, hand, state, activity, log);
    }
  }
}

/// Bodies that ties of the fat pull, ascending.
void CauteryEffects::findTied(std::size_t fat, const Bodies& bodies) {
  tied_.clear();
  for (const Tie& tie : model_.ties()) {
    if (tie.fat == fat && bodies.shareLeft(tie) > 0.0) tied_.push_back(tie.body[0]);
  }
  std::sort(tied_.begin(), tied_.end());
  tied_.erase(std::unique(tied_.begin(), tied_.end()), tied_.end());
}

/// Takes off the fat that the hook sweeps over.
FatStroke CauteryEffects::carve(const HookSweep& sweep, const Dose& dose, std::size_t fat, Bodies& bodies, State& state,
                                Activity& activity) {
  blades_.clear();
  const CauteryDescription& cautery = model_.scene().cautery;
  takeOutOfDimples(sweep, bodies.structureOfFat(fat), state, met_);
  for (const MovingCapsule& part : met_.electrode) {
    blades_.push_back({part.before[0], part.before[1], part.now[0], part.now[1], part.radius + cautery.reach});
  }
  findTied(fat, bodies);
  const FatStroke done = bodies.fat(fat).stroke(state, blades_, cautery.recession * dose.wall);
  if (done.changed) release(fat, bodies, activity);
  return done;
}

/// Fat is less than it was. @pre findTied() before
void CauteryEffects::release(std::size_t fat, const Bodies& bodies, Activity& activity) const {
  activity.carved[fat] = true;
  activity.reshape(bodies.firstFat() + fat);
  for (const std::size_t body : tied_) activity.disturb(body);  // it bears less now
}

/// Strings that are pulled too far part by themselves, one a step.
void CauteryEffects::tearFat(Bodies& bodies, State& state, Activity& activity, StepResult& result, StepLog& log) {
  for (std::size_t f = 0; f < bodies.fatCount(); ++f) {
    if (!activity.awake[bodies.firstFat() + f]) continue;
    findTied(f, bodies);
    const FatStroke done = bodies.fat(f).tear(state);
    if (!done.changed) continue;
    release(f, bodies, activity);
    result.fat[f].islands += done.islands;
    const std::size_t structure = bodies.structureOfFat(f);
    log.emit(EventKind::fatTorn, StepLog::noHand, structure, done.where, done.removed - done.islands);
    if (done.islands > 0.0) log.emit(EventKind::fatCameLoose, StepLog::noHand, structure, done.where, done.islands);
  }
}

void CauteryEffects::run(const HookSweeps& sweeps, const std::array<HookTouches, handCount>& touches, Bodies& bodies,
                         const Surfaces& surfaces, State& state, Activity& activity, StepResult& result, StepLog& log) {
  const CauteryDescription& cautery = model_.scene().cautery;
  for (FatResult& fat : result.fat) fat.carved = fat.islands = 0.0;
  for (std::size_t h = 0; h < handCount; ++h) {
    if (!sweeps[h].energised()) {
      result.hand[h].cautery = Cautery::off;
      emitSmoke(h, noStructure, 0.0, state, log);
      continue;
    }
    const std::uint32_t source = firstTouched(touches[h], bodies);
    const bool onTissue = source != noStructure;
    const double full = bodies.step() * touches[h].intensity(cautery.spot);
    const Dose dose{full * sweeps[h].pace, full * sweeps[h].charring};
    charOrgans(touches[h], dose, surfaces, state, activity, log);
    burnVessels(touches[h], dose, h, state, activity, log);
    for (std::size_t f = 0; f < touches[h].fat.size(); ++f) {
      if (!(touches[h].fat[f] > 0.0)) continue;
      const FatStroke done = carve(sweeps[h], dose, f, bodies, state, activity);
      if (!done.changed) continue;
      result.fat[f].carved += done.removed;
      result.fat[f].islands += done.islands;
      if (done.islands > 0.0) log.emit(EventKind::fatCameLoose, h, bodies.structureOfFat(f), done.where, done.islands);
    }
    result.hand[h].cautery = onTissue ? Cautery::onTissue : Cautery::withoutContact;
    emitSmoke(h, source, onTissue ? cautery.power * bodies.step() : 0.0, state, log);
  }
  tearFat(bodies, state, activity, result, log);
}

namespace {

double shareOf(const ConnectiveTissue& tissue, std::span<const std::uint32_t> strands) {
  double area = 0.0;
  for (const std::uint32_t s : strands) area += tissue.strands()[s].area;
  return area / tissue.area();
}

}  // namespace

void ConnectiveEffects::run(const HookSweeps& sweeps, const std::array<HookTouches, handCount>& touches, Bodies& bodies,
                            State& state, Activity& activity, StepResult& result, StepLog& log) {
  for (std::size_t c = 0; c < model_.connective().size(); ++c) {
    const ConnectiveModel& tie = model_.connective()[c];
    ConnectiveState& tissue = state.connective[c];
    ConnectiveResult& out = result.connective[c];
    const std::vector<Vec3>& a = state.organ[tie.a].position;
    const std::vector<Vec3>& b = state.organ[tie.b].position;
    const bool held = holdsAnything(tissue);
    out.hookTouches = 0;
    for (std::size_t h = 0; h < handCount; ++h) {
      if (touches[h].strand[c].empty()) continue;
      strands_.clear();
      const double seconds = bodies.step() * sweeps[h].pace * touches[h].intensity(model_.scene().cautery.spot);
      burnStrands(tie.tissue, tissue, touches[h].strand[c], seconds, strands_);
      out.hookTouches += static_cast<std::uint32_t>(touches[h].strand[c].size());
      if (!strands_.empty()) {
        log.emit(EventKind::strandsBurned, h, c, state.hand[h].instrument.position, shareOf(tie.tissue, strands_));
      }
    }
    strands_.clear();
    const DamageReport damage = advanceDamage(tie.tissue, tissue, a, b, strands_);
    out.maxPull = damage.maxTraction;
    if (!strands_.empty()) {
      log.emit(EventKind::strandsTorn, StepLog::noHand, c, tie.tissue.strands()[strands_[0]].a.of(a),
               shareOf(tie.tissue, strands_));
    }
    const ConnectiveShares shares = sharesOf(tie.tissue, tissue);
    out.attached = shares.attached;
    out.burned = shares.burned;
    out.torn = shares.torn;
    activity.frayed[c] = out.hookTouches > 0 || damage.grown;
    if (held && !holdsAnything(tissue)) {
      log.emit(EventKind::connectiveFreed, StepLog::noHand, c, Vec3::Zero(), shares.torn);
    }
    if (!activity.frayed[c]) continue;
    // Released tissue moves.
    activity.disturb(tie.a);
    activity.disturb(tie.b);
  }
}

}  // namespace calot
