// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/connective/connective_tissue.h"

#include <algorithm>
#include <utility>

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

}  // namespace

ConnectiveTissue::ConnectiveTissue(std::vector<Strand> strands, std::vector<std::array<std::uint32_t, 2>> sheets,
                                   ConnectiveMaterial material)
    : strand_(std::move(strands)), sheet_(std::move(sheets)), material_(material) {
  for (const Strand& strand : strand_) area_ += strand.area;
}

void ConnectiveTissue::preload(std::span<const Vec3> displacementA, std::span<const Vec3> displacementB) {
  for (Strand& strand : strand_) {
    strand.load = stiffnessOf(strand) * (strand.b.of(displacementB) - strand.a.of(displacementA));
  }
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
    Vec3 force = tension * stretch.direction;
    if (!strand.load.isZero(0.0)) {
      const double left = state.alpha[s] * (1.0 - state.damage[s]);
      const Vec3 load = b.rotation.empty() ? strand.load : Vec3(rotationOf(b.rotation, strand.b.element) * strand.load);
      force -= left * load;
    }
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

void touchStrands(const ConnectiveTissue& tissue, const ConnectiveState& state, const OrganMotion& a,
                  const OrganMotion& b, std::span<const MovingCapsule> hook, double reach, double step,
                  std::vector<StrandTouch>& touches) {
  const auto motion = [step](const MaterialPoint& point, const OrganMotion& organ) {
    const Vec3 now = point.of(organ.position);
    return MovingPoint{now - step * point.of(organ.velocity), now};
  };
  for (std::size_t s = 0; s < tissue.strands().size(); ++s) {
    if (state.condition[s] == StrandCondition::burned) continue;
    const Strand& strand = tissue.strands()[s];
    const std::array<MovingPoint, 2> end{motion(strand.a, a), motion(strand.b, b)};
    Box box;
    for (const MovingPoint& p : end) {
      box.include(p.before);
      box.include(p.now);
    }
    StepIntervals touched;
    for (const MovingCapsule& part : hook) {
      const bool attached = state.condition[s] == StrandCondition::attached;
      const double far = attached ? reach : reach + std::max(0.5 * strand.restLength, part.radius);
      if (!box.overlaps(boundsOf(part, far))) continue;
      if (attached) {
        touched.add(near(part, end, far));
      } else {
        touched.add(near(part, end[0], far));
        touched.add(near(part, end[1], far));
      }
    }
    if (!touched.empty()) touches.push_back({static_cast<std::uint32_t>(s), touched.length()});
  }
}

void burnStrands(const ConnectiveTissue& tissue, ConnectiveState& state, std::span<const StrandTouch> touches,
                 double seconds, std::vector<std::uint32_t>& burned) {
  const ConnectiveMaterial& m = tissue.material();
  for (const StrandTouch& touch : touches) {
    const std::size_t s = touch.strand;
    state.alpha[s] -= touch.share * seconds / m.fadeTime * (1.0 - m.goneBelow);
    if (state.alpha[s] > m.goneBelow) continue;
    state.alpha[s] = 0.0;
    state.condition[s] = StrandCondition::burned;
    burned.push_back(touch.strand);
  }
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
