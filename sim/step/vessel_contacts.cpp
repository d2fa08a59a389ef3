// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/tissue_contacts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/contact/surface_patches.h"
#include "sim/geometry/closest_point.h"
#include "sim/math/linear.h"

namespace calot {

namespace {

/// By which searches reach farther than contact, so that the next ones can be left out (m). Larger: each search finds
/// more triangles; smaller: searches are repeated after less motion. Measured on the whole operation.
constexpr double searchMargin = 0.003;
constexpr double rounding = 1e-9;   ///< of a motion (m)
constexpr double wholeOrgan = 0.3;  ///< no point inside an organ is farther from its surface (m)
/// A contact nearer to a capsule's end than this share of the capsule is that of the end. Assumed.
constexpr double endShare = 0.05;

Box boxOf(const VesselCapsule& c) {
  Box box;
  box.include(c.p0);
  box.include(c.p1);
  return box;
}

/// Position of a contact on a capsule.
enum class Place : std::uint8_t { start, between, end };

std::uint64_t keyOf(const VesselCapsule& c, Place place) {
  return (2 * c.element + (c.after ? 1 : 0)) * 4 + static_cast<std::uint64_t>(place);
}

}  // namespace

std::uint64_t structurePairNumber(const Model& model, std::size_t a, std::size_t b) {
  return model.tissuePairs().size() + a * maxStructures + b;
}

std::array<std::size_t, 2> structuresOfPair(const Model& model, std::uint64_t number) {
  const std::size_t pair = number - model.tissuePairs().size();
  return {pair / maxStructures, pair % maxStructures};
}

VesselContacts::VesselContacts(const Model& model, const TissueTravel& travel) : model_(model) {
  for (const VesselTree& tree : model.vesselTrees()) distances_.emplace_back(tree.beams);
  for (const Vessel& vessel : travel.vessels()) measureRest(vessel, nearby_.emplace_back());
  invalidate();
}

void VesselContacts::invalidate() {
  for (Nearby& n : nearby_) {
    n.toOrgan.assign(model_.organs().size(), {});
    n.toVessel.assign(nearby_.size(), {});
  }
}

/// Overlaps with organs in the reference configuration, and what a tie holds.
void VesselContacts::measureRest(const Vessel& vessel, Nearby& nearby) {
  const TreeDistances& along = distances_[vessel.tree];
  for (std::size_t o = 0; o < model_.organs().size(); ++o) {
    const OrganModel& organ = model_.organs()[o];
    std::vector<double>& offset = nearby.restOffset.emplace_back(vessel.rest.size(), 0.0);
    std::vector<bool>& tied = nearby.tied.emplace_back(vessel.rest.size(), false);
    const auto leaveOut = [&](int held) {
      for (std::size_t i = 0; i < tied.size(); ++i) {
        const VesselCapsule& c = vessel.rest[i];
        if (std::min(along.between(c.node0, held), along.between(c.node1, held)) < tiedReach) tied[i] = true;
      }
    };
    for (const Tie& tie : model_.ties()) {
      if (tie.fat == Tie::none && tie.body[0] == o && tie.body[1] == vessel.body) leaveOut(tie.place[1].node[0]);
    }
    Box whole;
    for (const Vec3& p : organ.skin) whole.include(p);
    std::vector<std::uint32_t> all(organ.surface.patches().size());
    std::iota(all.begin(), all.end(), 0U);
    for (std::size_t i = 0; i < offset.size(); ++i) {
      const VesselCapsule& c = vessel.rest[i];
      if (distanceOf(boxOf(c), whole) > vessel.radius) continue;
      const AxisDistance axis = axisDistance(organ.surface, organ.skin, all, c.p0, c.p1, wholeOrgan);
      if (axis.found && !axis.inside) offset[i] = notPositive(axis.distance - vessel.radius);
      if (!axis.inside) continue;
      leaveOut(c.node0);
      leaveOut(c.node1);
      for (const double s : {0.0, 0.5, 1.0}) {
        const NearestPoint nearest = nearestPoint(organ.surface, organ.skin, all, c.p0 + s * (c.p1 - c.p0), wholeOrgan);
        if (!nearest.found || !nearest.inside) continue;
        offset[i] = std::min(offset[i], -std::sqrt(nearest.point.squaredDistance) - vessel.radius);
      }
      found_.clear();
      capsuleContacts(organ.surface, organ.skin, all, c.p0, c.p1, vessel.radius, 0.0, 0, found_);
      for (const SurfaceContact& contact : found_) offset[i] = std::min(offset[i], contact.gap);
    }
  }
}

/// The surface's nearest point to an end of a capsule.
VesselContacts::Point VesselContacts::endOnOrgan(const Surfaces& surfaces, std::size_t organ,
                                                 std::span<const std::uint32_t> patches, const Vec3& end, double radius,
                                                 double reach) const {
  Point point;
  const NearestPoint nearest =
      nearestPoint(surfaces.mesh(organ), surfaces.points(organ), patches, end, capsuleSearch(radius, reach));
  if (!nearest.found) return point;
  const double distance = std::sqrt(nearest.point.squaredDistance);
  if (!(distance > rounding) || (nearest.inside && distance > maxAxisDepth)) return point;
  const Index3& corners = surfaces.mesh(organ).triangles()[nearest.triangle];
  point.gap = (nearest.inside ? -distance : distance) - radius;
  point.normal = (end - nearest.point.point) / (nearest.inside ? -distance : distance);
  point.node = {corners[0], corners[1], corners[2]};
  point.weight = nearest.point.barycentric;
  return point;
}

double VesselContacts::touchOrgan(const Surfaces& surfaces, const TissueTravel& travel, const State& state, double step,
                                  std::size_t o, std::size_t vessel, std::vector<ContactBlock>& blocks) {
  const Vessel& v = travel.vessels()[vessel];
  Nearby& nearby = nearby_[vessel];
  const double reach = 2.0 * allowedOverlap + std::min((v.speed + travel.organSpeed(o)) * step, maxApproach);
  const double near = capsuleSearch(v.radius, reach);
  const std::uint64_t pair = structurePairNumber(model_, o, v.structure) << pairShift;
  double depth = 0.0;
  Box whole;
  bool bounded = false;
  const auto add = [&](const VesselCapsule& c, double share, const Point& point, double offset, Place place) {
    const double gap = point.gap - offset;
    if (!(gap < reach)) return;
    if (std::any_of(point.node.begin(), point.node.end(), [&](int n) { return isInverted(model_, state, o, n); })) {
      return;
    }
    depth = std::max(depth, -gap);
    ContactBlock block;
    block.kind = BlockKind::unilateral;
    block.of = TissueOnTissue{
        {v.body, c.place(share)}, {o, surfaces.skin(o).influence(point.node, point.weight)}, vesselSoftness};
    block.direction[0] = point.normal;
    block.gap[0] = std::max(gap + allowedOverlap, -maxRecovery);
    block.key = pair | keyOf(c, place);
    blocks.push_back(block);
  };
  for (std::size_t i = 0; i < v.now.size(); ++i) {
    const VesselCapsule& c = v.now[i];
    Clearance& clearance = nearby.toOrgan[o][i];
    if (nearby.tied[o][c.element]) continue;
    if (clearance.distance > (clearance.outside ? v.radius + reach : near)) continue;
    if (!bounded) {
      for (const Box& patch : surfaces.bounds(o)) {
        whole.include(patch.lower);
        whole.include(patch.upper);
      }
      bounded = true;
    }
    const double limit = near + searchMargin;
    if (const double away = distanceOf(boxOf(c), whole); away > limit) {
      clearance = {away, true};
      continue;
    }
    const std::span<const std::uint32_t> patches = surfaces.patchesNear(o, c.p0, c.p1, limit, search_);
    clearance = {limit, false};
    if (patches.empty()) continue;
    ++searches_;
    const AxisDistance nearest = axisDistance(surfaces.mesh(o), surfaces.points(o), patches, c.p0, c.p1, limit);
    clearance = {nearest.distance, nearest.found && !nearest.inside};
    if (clearance.distance > (clearance.outside ? v.radius + reach : near)) continue;
    const double offset = nearby.restOffset[o][c.element];
    // A node is an end of two capsules, and of either's depth at rest.
    const bool follows = i > 0 && v.now[i - 1].node1 == c.node0 && !c.after;
    const Point first = endOnOrgan(surfaces, o, patches, c.p0, v.radius, reach);
    add(c, 0.0, first, follows ? std::min(offset, nearby.restOffset[o][v.now[i - 1].element]) : offset, Place::start);
    found_.clear();
    capsuleContacts(surfaces.mesh(o), surfaces.points(o), patches, c.p0, c.p1, v.radius, reach, 0, found_);
    const Point last = endOnOrgan(surfaces, o, patches, c.p1, v.radius, reach);
    Point between;
    between.gap = std::min(first.gap, last.gap) - allowedOverlap;
    double share = -1.0;
    for (const SurfaceContact& contact : found_) {
      const double s = closestOnSegment(contact.onAxis, c.p0, c.p1);
      if (s < endShare || s > 1.0 - endShare || !(contact.gap < between.gap)) continue;
      between = {contact.gap, contact.normal, contact.node, contact.weight};
      share = s;
    }
    if (share >= 0.0) add(c, share, between, offset, Place::between);
    if (i + 1 == v.now.size() || v.now[i + 1].after) add(c, 1.0, last, offset, Place::end);
  }
  return depth;
}

bool VesselContacts::areOneWall(const Vessel& a, std::size_t i, const Vessel& b, std::size_t j) const {
  if (a.tree != b.tree) return false;
  const TreeDistances& along = distances_[a.tree];
  double least = 1e300;
  for (const int m : {a.now[i].node0, a.now[i].node1}) {
    for (const int n : {b.now[j].node0, b.now[j].node1}) least = std::min(least, along.between(m, n));
  }
  return least < junctionReach * (a.radius + b.radius);
}

double VesselContacts::restOverlap(const Vessel& a, std::size_t i, const Vessel& b, std::size_t j) {
  const VesselCapsule& p = a.rest[a.now[i].element];
  const VesselCapsule& q = b.rest[b.now[j].element];
  return notPositive(std::sqrt(closestSegments(p.p0, p.p1, q.p0, q.p1).squaredDistance) - a.radius - b.radius);
}

double VesselContacts::touchVessel(const TissueTravel& travel, double step, std::size_t one, std::size_t two,
                                   std::vector<ContactBlock>& blocks) {
  const Vessel& a = travel.vessels()[one];
  const Vessel& b = travel.vessels()[two];
  const double reach = 2.0 * allowedOverlap + std::min((a.speed + b.speed) * step, maxApproach);
  const double near = a.radius + b.radius + reach;
  const std::uint64_t pair = structurePairNumber(model_, a.structure, b.structure) << pairShift;
  double depth = 0.0;
  /// The nearest of b's capsules to a segment on capsule i of a, nearer than `limit`.
  struct Nearest {
    SegmentSegment points;
    std::size_t with = 0;
    double distance = 0.0;
    bool found = false;
  };
  const auto nearestTo = [&](std::size_t i, const Vec3& p0, const Vec3& p1, double limit) {
    Nearest nearest;
    nearest.distance = limit;
    const Vec3 middle = 0.5 * (p0 + p1);
    const double half = 0.5 * (p1 - p0).norm();
    for (std::size_t j = 0; j < b.now.size(); ++j) {
      const VesselCapsule& q = b.now[j];
      const double far = nearest.distance + half + 0.5 * (q.p1 - q.p0).norm();
      if ((middle - 0.5 * (q.p0 + q.p1)).squaredNorm() > far * far || areOneWall(a, i, b, j)) continue;
      ++searches_;
      const SegmentSegment points = closestSegments(p0, p1, q.p0, q.p1);
      if (!(points.squaredDistance < nearest.distance * nearest.distance)) continue;
      nearest = {points, j, std::sqrt(points.squaredDistance), true};
    }
    return nearest;
  };
  const auto add = [&](std::size_t i, double share, const Nearest& nearest, Place place) {
    if (!nearest.found || !(nearest.distance > rounding)) return;
    const double gap = nearest.distance - a.radius - b.radius - restOverlap(a, i, b, nearest.with);
    if (!(gap < reach)) return;
    depth = std::max(depth, -gap);
    ContactBlock block;
    block.kind = BlockKind::unilateral;
    block.of = TissueOnTissue{
        {a.body, a.now[i].place(share)}, {b.body, b.now[nearest.with].place(nearest.points.t)}, vesselSoftness};
    block.direction[0] = (nearest.points.first - nearest.points.second) / nearest.distance;
    block.gap[0] = std::max(gap + allowedOverlap, -maxRecovery);
    block.key = pair | keyOf(a.now[i], place);
    blocks.push_back(block);
  };
  for (std::size_t i = 0; i < a.now.size(); ++i) {
    const VesselCapsule& p = a.now[i];
    Clearance& clearance = nearby_[one].toVessel[two][i];
    if (clearance.distance > near) continue;
    const Nearest whole = nearestTo(i, p.p0, p.p1, near + searchMargin);
    clearance.distance = whole.distance;
    if (whole.distance > near) continue;
    const Nearest first = nearestTo(i, p.p0, p.p0, near);
    const Nearest last = nearestTo(i, p.p1, p.p1, near);
    add(i, 0.0, first, Place::start);
    const double s = whole.points.s;
    if (s >= endShare && s <= 1.0 - endShare &&
        whole.distance < std::min(first.distance, last.distance) - allowedOverlap) {
      add(i, s, whole, Place::between);
    }
    if (i + 1 == a.now.size() || a.now[i + 1].after) add(i, 1.0, last, Place::end);
  }
  return depth;
}

double VesselContacts::run(const Surfaces& surfaces, const TissueTravel& travel, const State& state, double step,
                           const std::vector<bool>& awake, std::vector<ContactBlock>& blocks) {
  searches_ = 0;
  const auto wear = [](std::vector<Clearance>& list, std::size_t capsules, double motion) {
    list.resize(capsules);
    if (!(motion > 0.0)) return;
    for (Clearance& c : list) c.distance = std::max(c.distance - motion - rounding, -1.0);
  };
  const std::span<const Vessel> vessels = travel.vessels();
  double depth = 0.0;
  for (std::size_t o = 0; o < model_.organs().size(); ++o) {
    for (std::size_t v = 0; v < vessels.size(); ++v) {
      wear(nearby_[v].toOrgan[o], vessels[v].now.size(), vessels[v].motion + travel.organMotion(o));
      if (!awake[o] && !awake[vessels[v].body]) continue;
      depth = std::max(depth, touchOrgan(surfaces, travel, state, step, o, v, blocks));
    }
  }
  for (std::size_t one = 0; one < vessels.size(); ++one) {
    for (std::size_t two = one + 1; two < vessels.size(); ++two) {
      wear(nearby_[one].toVessel[two], vessels[one].now.size(), vessels[one].motion + vessels[two].motion);
      if (!awake[vessels[one].body] && !awake[vessels[two].body]) continue;
      depth = std::max(depth, touchVessel(travel, step, one, two, blocks));
    }
  }
  return depth;
}

}  // namespace calot
