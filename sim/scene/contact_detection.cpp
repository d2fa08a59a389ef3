// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a step that finds where instruments and organs may touch.
#include <algorithm>
#include <cmath>

#include "sim/geometry/closest_point.h"
#include "sim/scene/stepper_workspace.h"

namespace calot {

using namespace stepping;

namespace {

constexpr int largestAdvances = 16;        ///< conservative advancements a step
constexpr double tissueSlop = 2e-5;        ///< overlap that organs are left (m)
constexpr double foldDisplacement = 0.01;  ///< an organ that moved less from rest has not folded onto itself (m)

}  // namespace

void Stepper::Workspace::refreshBounds(const State& state) {
  for (std::size_t s = 0; s < skinOf.size(); ++s) {
    if (bounded[s]) continue;
    if (skinOf[s]->follow(state)) refittable[s] = false;
    skinOf[s]->place(state, skin[s]);
    earlierBounds.swap(bounds[s]);
    patchBounds(skinOf[s]->surface(), skin[s], 0.0, bounds[s]);
    if (earlierBounds.size() == bounds[s].size() && refittable[s]) {
      changedBounds(earlierBounds, bounds[s], patches);
      broad[s]->refit(bounds[s], patches);
    } else {
      broad[s]->update(bounds[s]);
    }
    refittable[s] = true;
    bounded[s] = true;
  }
}

std::span<const std::uint32_t> Stepper::Workspace::patchesNear(std::size_t structure, const Vec3& p0, const Vec3& p1,
                                                               double far) {
  Box box;
  box.include(p0);
  box.include(p1);
  box.grow(far);
  broad[structure]->pairs({&box, 1}, pairs);
  patches.clear();
  for (const BroadPhase::Pair& p : pairs) {
    // The box of an oblique shaft holds much that is not near it.
    const Box& patch = bounds[structure][p.leaf];
    const Vec3 middle = 0.5 * (patch.lower + patch.upper);
    const Vec3 onAxis = p0 + closestOnSegment(middle, p0, p1) * (p1 - p0);
    const double most = far + 0.5 * (patch.upper - patch.lower).norm();
    if ((middle - onAxis).squaredNorm() <= most * most * (1.0 + 1e-9)) patches.push_back(p.leaf);
  }
  return patches;
}

void Stepper::Workspace::shapeAt(const State& state, std::size_t hand, const Pose& pose, double jaw) {
  const HandDescription& description = model.scene().hands[hand];
  const double length = (pose.position - description.port).norm();
  local = instrumentShape(state.hand[hand].instrument, jaw, description.shaftRadius, length);
  const InstrumentShape world = placed(local, pose);
  shape.assign(world.capsules().begin(), world.capsules().end());
}

double Stepper::Workspace::allowance(const State& state, const HandState& hand, const Capsule& capsule,
                                     std::size_t structure) const {
  const bool jaw = capsule.part == Capsule::Part::upperJaw || capsule.part == Capsule::Part::lowerJaw;
  if (!jaw) return 0.0;
  if (isClosedOnClip(state, hand, structure)) return crushedDepth;
  return hand.grasped == structure ? heldDepth : 0.0;
}

/// Least gap between the instrument in `shape` and all structures, at most `reach_`. @pre refreshBounds() since
/// they moved
double Stepper::Workspace::gapOf(const State& state, const HandState& hand, double reach_) {
  double least = reach_;
  for (std::size_t s = 0; s < skinOf.size(); ++s) {
    for (const Capsule& c : shape) {
      const double allowed = allowance(state, hand, c, s);
      const double search = capsuleSearch(c.radius, std::max(least - allowed, 0.0));
      const std::span<const std::uint32_t> near = patchesNear(s, c.p0, c.p1, search);
      if (near.empty()) continue;
      least = allowed + leastGap(skinOf[s]->surface(), skin[s], near, c.p0, c.p1, c.radius, least - allowed);
    }
  }
  return least;
}

/// Conservative advancement (Mirtich 1996): the simulated instrument goes towards the real one as far as free space
/// reaches, so that nothing is passed through on the way. What is left is the stretch of the virtual coupling; the jaws
/// go on by a little whether there is room or not, since a hand closes them.
void Stepper::Workspace::advanceFreely(State& state, std::size_t hand) {
  HandState& h = state.hand[hand];
  const HandDescription& description = model.scene().hands[hand];
  const Pose real{h.realPosition, h.realOrientation};
  double left = 0.0;
  for (int i = 0;; ++i) {
    const Pose now = simulated(state, hand);
    const Vec3 way = real.position - now.position;
    const double roll = rollBetween(now.orientation, real.orientation);
    const double turn = h.realJaw - h.jaw;
    shapeAt(state, hand, now, std::max(h.jaw, h.realJaw));
    // No point of the instrument moves farther: turning about the port, it moves with the tip, and what stands off the
    // axis a little more.
    const double length = (now.position - description.port).norm();
    left = way.norm() * (1.0 + local.lateralReach() / length) + std::abs(roll) * local.lateralReach() +
           0.5 * std::abs(turn) * local.jawReach();
    if (!(left > 0.0)) break;
    shapeAt(state, hand, now, h.jaw);
    const double room = gapOf(state, h, left + 2.0 * margin);
    double share = 0.0;
    if (room >= left + margin) {
      share = 1.0;
    } else if (room > 1.05 * margin && i < largestAdvances) {
      share = (room - margin) / left;
    } else {
      h.jaw += std::clamp(turn, -largestJawStep, largestJawStep);
      break;
    }
    const Pose next = share == 1.0 ? throughPort(description.port, real.position, real.orientation,
                                                 now.orientation.toRotationMatrix().col(2))
                                   : movedTool(description.port, now, share * way, share * roll);
    h.simulatedPosition = next.position;
    h.simulatedOrientation = next.orientation;
    h.jaw = share == 1.0 ? h.realJaw : h.jaw + share * turn;
    if (share == 1.0) {
      left = 0.0;
      break;
    }
  }
  stretch[hand] = couplingStretch(simulated(state, hand), real, hapticModel(model, hand).largestStretch);
  reach[hand] = margin + std::min(left, largestSlide);
  contactSet[hand].reference = simulated(state, hand);
}

void Stepper::Workspace::addInstrumentBlock(const State& state, std::size_t hand, std::size_t structure,
                                            const SurfaceContact& contact) {
  const StructureModel& touched = model.structures()[structure];
  const Pose tool = simulated(state, hand);
  ContactBlock block;
  block.kind = touched.friction > 0.0 ? BlockKind::frictional : BlockKind::unilateral;
  block.limit = touched.friction;
  block.hand = hand;
  block.body = touched.body;
  block.structure = structure;
  block.place = skinOf[structure]->influence(contact.node, contact.weight);
  block.key = contact.key | static_cast<std::uint64_t>(structure) << 52U;
  // Slip along and across the shaft, as far as the surface allows.
  const Mat3 frame = alongAxis(contact.normal, tool.orientation.toRotationMatrix().col(2)).toRotationMatrix();
  block.direction = {contact.normal, frame.col(0), frame.col(1)};
  block.gap = {contact.gap, 0.0, 0.0};
  for (std::size_t k = 0; k < block.rows(); ++k) {
    block.tool[k] = toolRow(model.scene().hands[hand].port, tool, contact.onAxis, block.direction[k]);
  }
  blocks.push_back(block);
}

/// Counts the gaps of the contacts found last from `allowed` deeper, and drops those that are then too wide.
void Stepper::Workspace::allow(double allowed, double far, std::size_t from) {
  const auto first = found.begin() + static_cast<std::ptrdiff_t>(from);
  for (auto contact = first; contact != found.end(); ++contact) contact->gap += allowed;
  found.erase(std::remove_if(first, found.end(), [far](const SurfaceContact& c) { return !(c.gap < far); }),
              found.end());
}

/// Blocks of every instrument near every structure, in order of hand, structure and place.
void Stepper::Workspace::detectInstruments(const State& state) {
  blocks.clear();
  for (std::size_t h = 0; h < handCount; ++h) {
    shapeAt(state, h, simulated(state, h), state.hand[h].jaw);
    for (std::size_t o = 0; o < skinOf.size(); ++o) {
      double speed = 0.0;
      for (const Vec3& v : body[model.structures()[o].body]->velocity(state)) speed = std::max(speed, v.squaredNorm());
      const double far = reach[h] + std::min(std::sqrt(speed) * settings.step, largestSlide);
      found.clear();
      for (const Capsule& c : shape) {
        const double allowed = allowance(state, state.hand[h], c, o);
        const std::size_t before = found.size();
        const std::span<const std::uint32_t> near = patchesNear(o, c.p0, c.p1, capsuleSearch(c.radius, far));
        capsuleContacts(skinOf[o]->surface(), skin[o], near, c.p0, c.p1, c.radius, far, c.piece, found);
        if (allowed > 0.0) allow(allowed, far, before);
      }
      for (const SurfaceContact& contact : found) addInstrumentBlock(state, h, o, contact);
    }
  }
}

const SurfacePair& Stepper::Workspace::restOf(std::size_t pair) {
  const TissuePair& p = model.tissuePairs()[pair];
  if (p.rest.has_value()) return *p.rest;
  std::unique_ptr<const SurfacePair>& mine = selfRest[p.a];
  if (mine == nullptr) mine = std::make_unique<SurfacePair>(model.organs()[p.a].surface, model.organs()[p.a].skin);
  return *mine;
}

/// Is the tissue that a vertex of an organ's skin is part of turned inside out? Outward is then inward there, and
/// contact would hold it so.
bool Stepper::Workspace::isInsideOut(const State& state, std::size_t organ, int vertex) const {
  const auto& node = model.organs()[organ].embedding.anchors()[static_cast<std::size_t>(vertex)].node;
  const std::vector<Vec3>& position = state.organ[organ].position;
  const auto edge = [&](std::size_t k) -> Vec3 {
    return position[static_cast<std::size_t>(node[k])] - position[static_cast<std::size_t>(node[0])];
  };
  return !(edge(1).dot(edge(2).cross(edge(3))) > 0.0);
}

/// Blocks among organs that are awake; wet tissue on wet tissue slides without friction.
void Stepper::Workspace::detectTissue(const State& state) {
  result.contact.tissueDepth = 0.0;
  const std::size_t first = blocks.size();
  tissueGap.clear();
  displacement.resize(model.organs().size());
  for (SurfaceDisplacement& organ : displacement) organ.patch.clear();
  // From the skin at rest, from which all pairs are.
  const auto displaced = [&](std::size_t organ) -> const SurfaceDisplacement& {
    SurfaceDisplacement& own = displacement[organ];
    const OrganModel& fixed = model.organs()[organ];
    if (own.patch.empty()) measureDisplacement(fixed.surface, skin[organ], fixed.skin, own);
    return own;
  };
  for (std::size_t i = 0; i < model.tissuePairs().size(); ++i) {
    const TissuePair& pair = model.tissuePairs()[i];
    if (!moved[pair.a] && !moved[pair.b]) continue;
    if (pair.a == pair.b && state.organ[pair.a].largestDisplacement < foldDisplacement) continue;
    const double far = 2.0 * tissueSlop;
    const SurfacePair& rest_ = restOf(i);
    const ContactSurface& a = model.organs()[pair.a].surface;
    const ContactSurface& b = model.organs()[pair.b].surface;
    patchesInPlay(rest_, displaced(pair.a), displaced(pair.b), far, patches);
    if (patches.empty()) continue;
    queries.clear();
    for (const std::uint32_t p : patches) {
      queries.push_back(bounds[pair.a][p]);
      queries.back().grow(rest_.search(p, far));
    }
    broad[pair.b]->pairs(queries, pairs);
    for (BroadPhase::Pair& p : pairs) p.query = patches[p.query];
    foundVertices.clear();
    surfaceContacts(rest_, a, skin[pair.a], b, skin[pair.b], pairs, far, foundVertices, &nearTriangles[i]);
    for (const VertexContact& contact : foundVertices) {
      if (isInsideOut(state, pair.a, contact.vertex)) continue;
      if (std::any_of(contact.node.begin(), contact.node.end(), [&](int n) { return isInsideOut(state, pair.b, n); })) {
        continue;
      }
      result.contact.tissueDepth = std::max(result.contact.tissueDepth, -contact.gap);
      ContactBlock block;
      block.kind = BlockKind::unilateral;
      block.body = block.structure = pair.b;
      block.other = pair.a;
      block.direction[0] = contact.normal;
      block.place = skinOf[pair.b]->influence(contact.node, contact.weight);
      block.otherPlace = skinOf[pair.a]->influence({contact.vertex, contact.vertex, contact.vertex}, Vec3::UnitX());
      // Deep overlaps part over several steps, or they would be thrown apart.
      block.gap[0] = std::max(contact.gap + tissueSlop, -largestRecovery);
      block.key = contact.key | static_cast<std::uint64_t>(i) << 40U;
      tissueGap.push_back(contact.gap);
      blocks.push_back(block);
    }
  }
  keepDeepest(first);
}

/// Of the contacts between organs, from block `first` on, keeps those of the smallest gaps, in their order. Where an
/// organ is crumpled hundreds of its vertices are inside of it: more rows than its nodes can answer to.
void Stepper::Workspace::keepDeepest(std::size_t first) {
  if (blocks.size() - first <= mostTissueContacts) return;
  std::vector<std::pair<double, std::uint64_t>> rank;
  for (std::size_t b = first; b < blocks.size(); ++b) rank.emplace_back(tissueGap[b - first], blocks[b].key);
  const auto last = rank.begin() + static_cast<std::ptrdiff_t>(mostTissueContacts);
  std::nth_element(rank.begin(), last, rank.end());
  const std::pair<double, std::uint64_t> limit = *last;
  std::size_t kept = first;
  for (std::size_t b = first; b < blocks.size(); ++b) {
    if (!(std::pair(tissueGap[b - first], blocks[b].key) < limit)) continue;
    if (kept != b) blocks[kept] = blocks[b];
    ++kept;
  }
  blocks.resize(kept);
}

}  // namespace calot
