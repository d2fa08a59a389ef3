// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/tissue_contacts.h"

#include <algorithm>
#include <array>

#include "sim/step/contact_problem.h"

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

double TissueContacts::addPair(Surfaces& surfaces, const State& state, std::size_t number,
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
    block.body = block.structure = pair.b;
    block.other = pair.a;
    block.softness = tissueSoftness;
    block.direction[0] = contact.normal;
    block.place = surfaces.skin(pair.b).influence(contact.node, contact.weight);
    block.otherPlace = surfaces.skin(pair.a).influence({contact.vertex, contact.vertex, contact.vertex}, Vec3::UnitX());
    // Deep overlaps part over several steps, or organs would be thrown apart.
    block.gap[0] = std::max(contact.gap + allowedOverlap, -maxRecovery);
    block.key = contact.key | static_cast<std::uint64_t>(number) << 40U;
    gap_.push_back(contact.gap);
    blocks.push_back(block);
  }
  return depth;
}

double TissueContacts::run(Surfaces& surfaces, const State& state, const std::vector<bool>& awake,
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

}  // namespace calot
