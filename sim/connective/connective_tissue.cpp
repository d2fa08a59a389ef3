// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/connective/connective_tissue.h"

#include <algorithm>
#include <utility>

#include "sim/geometry/closest_point.h"

namespace calot {

namespace {

constexpr double minLength = 1e-6;  ///< m: shorter strands take their direction at rest

struct Stretch {
  Vec3 direction = Vec3::Zero();
  double length = 0.0;
};

Stretch stretchOf(const Strand& strand, const Vec3& a, const Vec3& b) {
  const Vec3 way = a - b;
  const double length = way.norm();
  if (length < minLength) return {strand.restDirection, length};
  return {way / length, length};
}

/// Does a segment come within `limit` of the quadrilateral that the part's axis sweeps?
bool within(const Vec3& p, const Vec3& q, const HookSweep& part, double limit) {
  Box reach;
  for (const Vec3& x : part.before) reach.include(x);
  for (const Vec3& x : part.now) reach.include(x);
  reach.grow(limit);
  Box box;
  box.include(p);
  box.include(q);
  if (!box.overlaps(reach)) return false;
  const double first = closestSegmentTriangle(p, q, part.before[0], part.before[1], part.now[1]).squaredDistance;
  const double second = closestSegmentTriangle(p, q, part.before[0], part.now[1], part.now[0]).squaredDistance;
  return std::min(first, second) <= limit * limit;
}

}  // namespace

ConnectiveTissue::ConnectiveTissue(std::vector<Strand> strands, std::vector<std::array<std::uint32_t, 2>> sheets,
                                   ConnectiveMaterial material)
    : strand_(std::move(strands)), sheet_(std::move(sheets)), material_(material) {
  for (const Strand& strand : strand_) area_ += strand.area;
}

ConnectiveState intactState(const ConnectiveTissue& tissue) {
  ConnectiveState state;
  state.condition.assign(tissue.strands().size(), StrandCondition::attached);
  state.alpha.assign(tissue.strands().size(), 1.0);
  state.damage.assign(tissue.strands().size(), 0.0);
  return state;
}

void linearise(const ConnectiveTissue& tissue, const ConnectiveState& state, const OrganMotion& a, const OrganMotion& b,
               double step, ConnectiveLoads& out) {
  const ConnectiveMaterial& m = tissue.material();
  const CohesiveLaw law = m.law();
  out.onA.clear();
  out.onB.clear();
  out.damper.assign(tissue.strands().size(), 0.0);
  for (std::size_t s = 0; s < tissue.strands().size(); ++s) {
    if (state.condition[s] != StrandCondition::attached) continue;
    const Strand& strand = tissue.strands()[s];
    const Stretch stretch = stretchOf(strand, strand.a.of(a.position), strand.b.of(b.position));
    const Vec3 velocityA = strand.a.of(a.velocity);
    const Vec3 velocityB = strand.b.of(b.velocity);
    const double section = state.alpha[s] * strand.area;
    const double separation = stretch.length - strand.restLength;
    const double tension = section * law.secant(separation, state.damage[s]) * separation;
    // A strand that closes within the step may end in compression, where it is intact.
    const double ahead = separation + std::min(step * stretch.direction.dot(velocityA - velocityB), 0.0);
    const double secant = law.secant(ahead, state.damage[s]);
    const double damper = section * (step * secant + m.damping * (secant / m.stiffness));
    const Vec3 force = tension * stretch.direction;
    out.damper[s] = damper;
    Attachment& onA = out.onA.emplace_back();
    onA.point = strand.a;
    onA.damper = damper * Mat3::Identity();
    onA.force = damper * velocityB - force;
    Attachment& onB = out.onB.emplace_back();
    onB.point = strand.b;
    onB.damper = onA.damper;
    onB.force = damper * velocityA + force;
  }
}

double strandTension(const ConnectiveTissue& tissue, const ConnectiveState& state, std::size_t strand,
                     std::span<const Vec3> positionA, std::span<const Vec3> positionB) {
  if (state.condition[strand] != StrandCondition::attached) return 0.0;
  const Strand& s = tissue.strands()[strand];
  const double separation = stretchOf(s, s.a.of(positionA), s.b.of(positionB)).length - s.restLength;
  return state.alpha[strand] * s.area * tissue.material().law().secant(separation, state.damage[strand]) * separation;
}

DamageReport advanceDamage(const ConnectiveTissue& tissue, ConnectiveState& state, std::span<const Vec3> positionA,
                           std::span<const Vec3> positionB, std::vector<std::uint32_t>& torn) {
  const CohesiveLaw law = tissue.material().law();
  DamageReport report;
  for (std::size_t s = 0; s < tissue.strands().size(); ++s) {
    if (state.condition[s] != StrandCondition::attached) continue;
    const Strand& strand = tissue.strands()[s];
    const double separation =
        stretchOf(strand, strand.a.of(positionA), strand.b.of(positionB)).length - strand.restLength;
    const double damage = law.damageAt(separation);
    if (damage > state.damage[s]) {
      state.damage[s] = damage;
      report.grown = true;
    }
    report.maxTraction = std::max(report.maxTraction, law.secant(separation, state.damage[s]) * separation);
    if (state.damage[s] < 1.0) continue;
    state.condition[s] = StrandCondition::torn;
    torn.push_back(static_cast<std::uint32_t>(s));
  }
  return report;
}

std::size_t burnStrands(const ConnectiveTissue& tissue, ConnectiveState& state, std::span<const Vec3> positionA,
                        std::span<const Vec3> positionB, std::span<const HookSweep> hook, double step,
                        std::vector<std::uint32_t>& burned) {
  const ConnectiveMaterial& m = tissue.material();
  std::size_t touched = 0;
  for (std::size_t s = 0; s < tissue.strands().size(); ++s) {
    if (state.condition[s] == StrandCondition::burned) continue;
    const Strand& strand = tissue.strands()[s];
    const Vec3 a = strand.a.of(positionA);
    const Vec3 b = strand.b.of(positionB);
    const bool attached = state.condition[s] == StrandCondition::attached;
    const bool touches = std::any_of(hook.begin(), hook.end(), [&](const HookSweep& part) {
      if (attached) return within(a, b, part, part.radius);
      const double stump = part.radius + std::max(0.5 * strand.restLength, part.radius);
      return within(a, a, part, stump) || within(b, b, part, stump);
    });
    if (!touches) continue;
    ++touched;
    state.alpha[s] -= step / m.fadeTime * (1.0 - m.goneBelow);
    if (state.alpha[s] > m.goneBelow) continue;
    state.alpha[s] = 0.0;
    state.condition[s] = StrandCondition::burned;
    burned.push_back(static_cast<std::uint32_t>(s));
  }
  return touched;
}

ConnectiveShares sharesOf(const ConnectiveTissue& tissue, const ConnectiveState& state) {
  ConnectiveShares shares;
  if (!(tissue.area() > 0.0)) return shares;
  for (std::size_t s = 0; s < tissue.strands().size(); ++s) {
    const double share = tissue.strands()[s].area;
    switch (state.condition[s]) {
      case StrandCondition::attached:
        shares.attached += share;
        break;
      case StrandCondition::burned:
        shares.burned += share;
        break;
      case StrandCondition::torn:
        shares.torn += share;
        break;
    }
  }
  // If all strands are of one kind, its share is exactly 1: sums run in the same order as the area's.
  shares.attached /= tissue.area();
  shares.burned /= tissue.area();
  shares.torn /= tissue.area();
  return shares;
}

}  // namespace calot
