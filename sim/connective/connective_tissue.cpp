// SPDX-License-Identifier: GPL-3.0-or-later
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

ConnectiveState intactState(const ConnectiveTissue& tissue) {
  ConnectiveState state;
  state.condition.assign(tissue.strands().size(), StrandCondition::attached);
  state.alpha.assign(tissue.strands().size(), 1.0);
  return state;
}

void addConnectiveLoads(const ConnectiveTissue& tissue, const ConnectiveState& state, ConnectiveSide side,
                        const OrganMotion& own, const OrganMotion& other, double step, std::vector<Attachment>& out) {
  const ConnectiveMaterial& m = tissue.material();
  for (std::size_t s = 0; s < tissue.strands().size(); ++s) {
    if (state.condition[s] != StrandCondition::attached) continue;
    const Strand& strand = tissue.strands()[s];
    const MaterialPoint& ownPoint = side == ConnectiveSide::a ? strand.a : strand.b;
    const MaterialPoint& otherPoint = side == ConnectiveSide::a ? strand.b : strand.a;
    const Vec3 here = ownPoint.of(own.position);
    const Vec3 there = otherPoint.of(other.position);
    // d points from b to a for both sides; the two ends get opposite forces along it.
    const Stretch stretch = side == ConnectiveSide::a ? stretchOf(strand, here, there) : stretchOf(strand, there, here);
    const double stiffness = state.alpha[s] * m.stiffness * strand.area;
    const double damping = state.alpha[s] * m.damping * strand.area;
    const double tension = stiffness * (stretch.length - strand.restLength);
    const Vec3 force =
        side == ConnectiveSide::a ? Vec3(-tension * stretch.direction) : Vec3(tension * stretch.direction);
    Attachment attachment;
    attachment.point = ownPoint;
    // An isotropic majorant of the spring's tangent stiffness: equilibrium is unchanged, motion is damped more, and the
    // step is never unstable.
    attachment.damper = (step * stiffness + damping) * Mat3::Identity();
    attachment.force = force + attachment.damper * otherPoint.of(other.velocity);
    out.push_back(attachment);
  }
}

double strandTension(const ConnectiveTissue& tissue, const ConnectiveState& state, std::size_t strand,
                     std::span<const Vec3> positionA, std::span<const Vec3> positionB) {
  if (state.condition[strand] != StrandCondition::attached) return 0.0;
  const Strand& s = tissue.strands()[strand];
  const Stretch stretch = stretchOf(s, s.a.of(positionA), s.b.of(positionB));
  return state.alpha[strand] * tissue.material().stiffness * s.area * (stretch.length - s.restLength);
}

double tearOverstretched(const ConnectiveTissue& tissue, ConnectiveState& state, std::span<const Vec3> positionA,
                         std::span<const Vec3> positionB, std::vector<std::uint32_t>& torn) {
  double largest = 0.0;
  for (std::size_t s = 0; s < tissue.strands().size(); ++s) {
    if (state.condition[s] != StrandCondition::attached) continue;
    const double area = tissue.strands()[s].area;
    const double tension = strandTension(tissue, state, s, positionA, positionB);
    // Fading reduces strength and stiffness alike, so that the stretch at which a strand tears is unchanged.
    const double stress = tension / (state.alpha[s] * area);
    largest = std::max(largest, stress);
    if (!(stress > tissue.material().strength)) continue;
    state.condition[s] = StrandCondition::torn;
    torn.push_back(static_cast<std::uint32_t>(s));
  }
  return largest;
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
