// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/tissue_contacts.h"

#include <algorithm>
#include <cmath>

#include "sim/step/body.h"
#include "sim/step/stages.h"
#include "sim/vessel/beam_state.h"

namespace calot {

namespace {

/// An organ that moved less from rest has not folded onto itself (m). Larger misses folds; smaller tests rest shapes
/// against themselves. Assumed: less than half of any organ's thickness.
constexpr double foldDisplacement = 0.01;
/// Between organs, the deepest; a coarse solid has no use for more. Larger costs time (rows cubed), smaller lets
/// crumpled organs sink in. Measured on the whole operation.
constexpr std::size_t maxTissueContacts = 96;

}  // namespace

TissueContacts::TissueContacts(const Model& model) : model_(model) {
  selfRest_.resize(model.organs().size());
  nearTriangles_.resize(model.tissuePairs().size());
  displacement_.resize(model.organs().size());
}

void TissueContacts::invalidate() {
  for (NearTriangles& lists : nearTriangles_) lists.reset();
}

void TissueContacts::precompute() {
  for (std::size_t pair = 0; pair < model_.tissuePairs().size(); ++pair) {
    nearTriangles_[pair].precompute(restOf(pair), model_.organs()[model_.tissuePairs()[pair].b].surface);
  }
}

/// Tables of a tissue pair's reference configuration; those of an organ with itself are computed on first use.
const SurfacePair& TissueContacts::restOf(std::size_t pair) {
  const TissuePair& p = model_.tissuePairs()[pair];
  if (p.rest.has_value()) return *p.rest;
  std::unique_ptr<const SurfacePair>& own = selfRest_[p.a];
  if (own == nullptr) own = std::make_unique<SurfacePair>(model_.organs()[p.a].surface, model_.organs()[p.a].skin);
  return *own;
}

/// How far an organ's skin is from its reference configuration, once a step.
const SurfaceDisplacement& TissueContacts::displacementOf(const Surfaces& surfaces, std::size_t organ) {
  SurfaceDisplacement& own = displacement_[organ];
  const OrganModel& fixed = model_.organs()[organ];
  if (own.patch.empty()) measureDisplacement(fixed.surface, surfaces.points(organ), fixed.skin, own);
  return own;
}

bool isInverted(const Model& model, const State& state, std::size_t organ, int vertex) {
  const auto& node = model.organs()[organ].embedding.anchors()[static_cast<std::size_t>(vertex)].node;
  const std::vector<Vec3>& position = state.organ[organ].position;
  const auto edge = [&](std::size_t k) -> Vec3 {
    return position[static_cast<std::size_t>(node[k])] - position[static_cast<std::size_t>(node[0])];
  };
  return !(edge(1).dot(edge(2).cross(edge(3))) > 0.0);
}

double TissueContacts::addPair(const Surfaces& surfaces, const State& state, std::size_t number,
                               std::vector<ContactBlock>& blocks) {
  const TissuePair& pair = model_.tissuePairs()[number];
  const double far = 2.0 * allowedOverlap;
  const SurfacePair& rest = restOf(number);
  const ContactSurface& a = model_.organs()[pair.a].surface;
  const ContactSurface& b = model_.organs()[pair.b].surface;
  patchesInPlay(rest, displacementOf(surfaces, pair.a), displacementOf(surfaces, pair.b), far, patches_);
  if (patches_.empty()) return 0.0;
  queries_.clear();
  for (const std::uint32_t p : patches_) {
    queries_.push_back(surfaces.bounds(pair.a)[p]);
    queries_.back().grow(rest.search(p, far));
  }
  surfaces.broadPhase(pair.b).pairs(queries_, pairs_);
  for (BroadPhase::Pair& p : pairs_) p.query = patches_[p.query];
  found_.clear();
  surfaceContacts(rest, a, surfaces.points(pair.a), b, surfaces.points(pair.b), pairs_, far, found_,
                  &nearTriangles_[number]);
  double depth = 0.0;
  for (const VertexContact& contact : found_) {
    if (isInverted(model_, state, pair.a, contact.vertex)) continue;
    if (std::any_of(contact.node.begin(), contact.node.end(),
                    [&](int n) { return isInverted(model_, state, pair.b, n); })) {
      continue;
    }
    depth = std::max(depth, -contact.gap);
    ContactBlock block;
    block.kind = BlockKind::unilateral;
    block.of = TissueOnTissue{
        {pair.a, surfaces.skin(pair.a).influence({contact.vertex, contact.vertex, contact.vertex}, Vec3::UnitX())},
        {pair.b, surfaces.skin(pair.b).influence(contact.node, contact.weight)},
        tissueSoftness};
    block.direction[0] = contact.normal;
    // Deep overlaps part over several steps, or organs would be thrown apart.
    block.gap[0] = std::max(contact.gap + allowedOverlap, -maxRecovery);
    block.key = contact.key | static_cast<std::uint64_t>(number) << pairShift;
    gap_.push_back(contact.gap);
    blocks.push_back(block);
  }
  return depth;
}

double TissueContacts::run(const Surfaces& surfaces, const State& state, const std::vector<bool>& awake,
                           std::vector<ContactBlock>& blocks) {
  const std::size_t first = blocks.size();
  double depth = 0.0;
  gap_.clear();
  for (SurfaceDisplacement& organ : displacement_) organ.patch.clear();
  for (std::size_t i = 0; i < model_.tissuePairs().size(); ++i) {
    const TissuePair& pair = model_.tissuePairs()[i];
    if (!awake[pair.a] && !awake[pair.b]) continue;
    if (pair.a == pair.b && state.organ[pair.a].maxDisplacement < foldDisplacement) continue;
    depth = std::max(depth, addPair(surfaces, state, i, blocks));
  }
  keepDeepest(first, maxTissueContacts, gap_, blocks);
  return depth;
}

void keepDeepest(std::size_t first, std::size_t limit, std::span<const double> gap, std::vector<ContactBlock>& blocks) {
  if (blocks.size() - first <= limit) return;
  std::vector<std::pair<double, std::uint64_t>> rank;
  for (std::size_t b = first; b < blocks.size(); ++b) rank.emplace_back(gap[b - first], blocks[b].key);
  const auto last = rank.begin() + static_cast<std::ptrdiff_t>(limit);
  std::nth_element(rank.begin(), last, rank.end());
  const std::pair<double, std::uint64_t> deepest = *last;
  std::size_t kept = first;
  for (std::size_t b = first; b < blocks.size(); ++b) {
    if (!(std::pair(gap[b - first], blocks[b].key) < deepest)) continue;
    if (kept != b) blocks[kept] = blocks[b];
    ++kept;
  }
  blocks.resize(kept);
}

SolidSolver::Impulse VesselCapsule::place(double s) const {
  SolidSolver::Impulse out;
  addShare(out, node0, 1.0 - s);
  addShare(out, node1, s);
  return out;
}

void vesselCapsules(const BeamModel& beams, const BeamState& state, std::size_t branch,
                    std::vector<VesselCapsule>& out) {
  out.clear();
  const BeamModel::Branch& fixed = beams.branches()[branch];
  for (std::size_t i = 0; i < fixed.elements(); ++i) {
    const std::size_t e = fixed.firstElement + i;
    const BeamElement& element = beams.elements()[e];
    const Vec3& a = state.position[static_cast<std::size_t>(element.a)];
    const Vec3& b = state.position[static_cast<std::size_t>(element.b)];
    if (state.parting[e] == Parting::none) {
      out.push_back({a, b, element.a, element.b, i, false});
      continue;
    }
    const BeamPoint cut{branch, e, state.partedAt[e], 0.0};
    out.push_back({a, centreLine(beams, state, cut, Stump::before).position, element.a, element.a, i, false});
    out.push_back({centreLine(beams, state, cut, Stump::after).position, b, element.b, element.b, i, true});
  }
}

TreeDistances::TreeDistances(const BeamModel& beams) : nodes_(beams.nodes()), distance_(nodes_ * nodes_, 1e300) {
  // Nodes stand behind their parents, so each row takes what the rows before it have.
  for (std::size_t n = 0; n < nodes_; ++n) {
    distance_[n * nodes_ + n] = 0.0;
    if (beams.parents()[n] < 0) continue;
    const auto parent = static_cast<std::size_t>(beams.parents()[n]);
    const double length = beams.elements()[static_cast<std::size_t>(beams.elementBefore(n))].length;
    for (std::size_t m = 0; m < n; ++m) {
      distance_[n * nodes_ + m] = distance_[m * nodes_ + n] = distance_[parent * nodes_ + m] + length;
    }
  }
}

namespace {

constexpr double unseenMotion = 1e300;  ///< a motion of what was not seen before (m)

double largestSpeed(std::span<const Vec3> velocity) {
  double speed = 0.0;
  for (const Vec3& v : velocity) speed = std::max(speed, v.squaredNorm());
  return std::sqrt(speed);
}

}  // namespace

TissueTravel::TissueTravel(const Model& model) : model_(model) {
  for (std::size_t s = 0; s < model.structures().size(); ++s) {
    const StructureModel& structure = model.structures()[s];
    if (structure.kind != tissueId<VesselTissue>) continue;
    Vessel& vessel = vessel_.emplace_back();
    vessel.tree = structure.index;
    vessel.branch = structure.branch;
    vessel.structure = s;
    vessel.body = structure.body;
    const BeamModel& beams = model.vesselTrees()[vessel.tree].beams;
    vessel.radius = beams.branches()[vessel.branch].section.outerRadius;
    vesselCapsules(beams, restState(beams), vessel.branch, vessel.rest);
  }
  invalidate();
}

void TissueTravel::invalidate() {
  for (Vessel& v : vessel_) v.before.clear();
  organBefore_.assign(model_.organs().size(), {});
  organMotion_.assign(model_.organs().size(), 0.0);
  organSpeed_.assign(model_.organs().size(), 0.0);
  wasAwake_.assign(model_.bodies(), true);
}

void TissueTravel::follow(const Surfaces& surfaces, const Bodies& bodies, const State& state,
                          const std::vector<bool>& awake) {
  if (vessel_.empty() && model_.fat().empty()) return;  // no other body needs it
  for (std::size_t o = 0; o < organBefore_.size(); ++o) {
    organMotion_[o] = 0.0;
    organSpeed_[o] = awake[o] ? largestSpeed(bodies[o].velocity(state)) : 0.0;
    const std::vector<Vec3>& now = surfaces.points(o);
    std::vector<Vec3>& before = organBefore_[o];
    if (!awake[o] && !wasAwake_[o] && before.size() == now.size()) continue;
    double moved = before.size() == now.size() ? 0.0 : unseenMotion;
    for (std::size_t i = 0; i < now.size() && moved < unseenMotion; ++i)
      moved = std::max(moved, (now[i] - before[i]).squaredNorm());
    organMotion_[o] = std::sqrt(moved);
    before = now;
  }
  for (Vessel& v : vessel_) {
    v.motion = 0.0;
    v.speed = awake[v.body] ? largestSpeed(bodies[v.body].velocity(state)) : 0.0;
    if (!awake[v.body] && !wasAwake_[v.body] && !v.before.empty()) continue;
    v.before.swap(v.now);
    vesselCapsules(model_.vesselTrees()[v.tree].beams, state.vessel[v.tree], v.branch, v.now);
    if (v.before.size() != v.now.size()) v.motion = unseenMotion;
    double moved = 0.0;
    for (std::size_t i = 0; i < v.now.size() && v.motion == 0.0; ++i) {
      moved =
          std::max({moved, (v.now[i].p0 - v.before[i].p0).squaredNorm(), (v.now[i].p1 - v.before[i].p1).squaredNorm()});
    }
    v.motion = std::max(v.motion, std::sqrt(moved));
    if (v.before.empty()) v.before = v.now;
  }
  wasAwake_ = awake;
}

}  // namespace calot
