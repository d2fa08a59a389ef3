// SPDX-License-Identifier: GPL-3.0-or-later

#include "sim/step/instrument_clash.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "sim/geometry/closest_point.h"
#include "sim/vessel/centre_line.h"

namespace calot {

namespace {

/// That jaws may sink into what they grasp (m): about the thickness of a fold of gallbladder wall. Larger: the
/// instrument sticks in tissue after release; smaller: tissue is pushed out of closing jaws. Assumed.
constexpr double graspedDepth = 0.0035;
/// The same about a clip (m): deeper than any vessel is thick. Larger changes nothing.
constexpr double crushedDepth = 0.02;

/// Are these the jaws of an applier that has closed, and not opened since, about a clip of this vessel? They crush what
/// they clip; blunt bodies that closed on a tube which cannot give way would throw it about.
bool isClosedOnClip(const Model& model, const State& state, const HandState& hand, std::size_t structure) {
  const StructureModel& s = model.structures()[structure];
  if (s.kind != tissueId<VesselTissue> || hand.jawsOpened) return false;
  if (instrumentOf(hand.instrument).action != InstrumentAction::clip) return false;
  const BeamModel& beams = model.vesselTrees()[s.index].beams;
  const BeamState& vessels = state.vessel[s.index];
  const double reach = 1.5 * model.scene().clip.legs;
  for (std::size_t c = 0; c < vessels.clips(); ++c) {
    if (vessels.clipBranch[c] != s.branch) continue;
    const Vec3 where = centreLine(beams, vessels, pointAt(beams, s.branch, vessels.clipPlace[c])).position;
    if ((where - hand.simulatedPosition).squaredNorm() < reach * reach) return true;
  }
  return false;
}

}  // namespace

double currentPace(const CauteryDescription& cautery, const HandState& hand) {
  if (instrumentOf(hand.instrument).action != InstrumentAction::burn) return 0.0;
  if ((hand.buttons & button::cutPedal) != 0) return 1.0;
  return (hand.buttons & button::coagulatePedal) != 0 ? cautery.coagulationPace : 0.0;
}

void PlacedInstrument::place(const HandDescription& hand, InstrumentKind kind, const Pose& at, double jaw) {
  const double length = (at.position - hand.port).norm();
  local = instrumentShape(kind, jaw, hand.shaftRadius, length);
  pose = at;
  port = hand.port;
  const InstrumentShape world = placed(local, pose);
  capsule.assign(world.capsules().begin(), world.capsules().end());
}

double allowedDepth(const Model& model, const State& state, std::size_t hand, const Capsule& capsule,
                    std::size_t structure) {
  if (capsule.part == Capsule::Part::electrode && model.structures()[structure].kind == tissueId<FatTissue>)
    return currentPace(model.scene().cautery, state.hand[hand]) * model.scene().cautery.recession * model.stepSeconds();
  const bool jaw = capsule.part == Capsule::Part::upperJaw || capsule.part == Capsule::Part::lowerJaw;
  if (!jaw) return 0.0;
  const HandState& h = state.hand[hand];
  if (isClosedOnClip(model, state, h, structure)) return crushedDepth;
  return h.grasped == structure ? graspedDepth : 0.0;
}

namespace {

/// Contact points nearer to each other are one: neighbouring pieces of a shaft share their ends (m). Assumed: two radii
/// of a shaft.
constexpr double sameClash = 0.005;
constexpr double crossingAxes = 1e-9;  ///< m: nearer than this, the direction of the distance is noise
/// Share of the tip's distance from the port below which a point is in the port: a force there moves the tip by less
/// than this share. Larger: shafts pass through each other near their ports; smaller: forces of any size act there.
/// Assumed.
constexpr double portShare = 0.1;

/// The instrument's axis, from its farthest point back to its foremost, and how far anything of it is from that.
struct Spine {
  Vec3 back, front;
  double radius = 0.0;
};
Spine spineOf(const PlacedInstrument& instrument) {
  double from = 1e300;
  double to = -1e300;
  const std::span<const Capsule> local = instrument.local.capsules();
  Spine spine;
  for (const Capsule& c : local) {
    from = std::min({from, c.p0[2], c.p1[2]});
    to = std::max({to, c.p0[2], c.p1[2]});
    spine.radius = std::max(spine.radius, c.radius);
  }
  spine.radius += instrument.local.lateralReach();
  spine.back = instrument.pose.position + instrument.pose.orientation * Vec3(0.0, 0.0, from);
  spine.front = instrument.pose.position + instrument.pose.orientation * Vec3(0.0, 0.0, to);
  return spine;
}

bool isInPort(const PlacedInstrument& instrument, const Vec3& point) {
  const double reach = portShare * portShare * (instrument.pose.position - instrument.port).squaredNorm();
  return (point - instrument.port).squaredNorm() < reach;
}

}  // namespace

bool surelyApart(const PlacedInstrument& a, const PlacedInstrument& b, double reach) {
  if (a.capsule.empty() || b.capsule.empty()) return true;
  const Spine one = spineOf(a);
  const Spine two = spineOf(b);
  const double far = (one.radius + two.radius + reach) * (1.0 + 1e-9);
  return closestSegments(one.back, one.front, two.back, two.front).squaredDistance > far * far;
}

double gapBetween(const PlacedInstrument& a, const PlacedInstrument& b, double limit) {
  if (surelyApart(a, b, limit)) return limit;
  double least = limit;
  for (const Capsule& p : a.capsule) {
    for (const Capsule& q : b.capsule) {
      const SegmentSegment near = closestSegments(p.p0, p.p1, q.p0, q.p1);
      const double gap = std::sqrt(near.squaredDistance) - p.radius - q.radius;
      if (gap < least && !isInPort(a, near.first) && !isInPort(b, near.second)) least = gap;
    }
  }
  return least;
}

void clashPoints(const PlacedInstrument& a, const PlacedInstrument& b, double reach, std::vector<ClashPoint>& out) {
  out.clear();
  if (surelyApart(a, b, reach)) return;
  for (const Capsule& p : a.capsule) {
    for (const Capsule& q : b.capsule) {
      const SegmentSegment near = closestSegments(p.p0, p.p1, q.p0, q.p1);
      const double distance = std::sqrt(near.squaredDistance);
      const double gap = distance - p.radius - q.radius;
      if (!(gap < reach) || isInPort(a, near.first) || isInPort(b, near.second)) continue;
      ClashPoint point;
      point.onA = near.first;
      point.onB = near.second;
      point.gap = gap;
      point.key = clashKey | static_cast<std::uint64_t>(p.piece) << 8U | q.piece;
      if (distance > crossingAxes) {
        point.normal = (near.first - near.second) / distance;
      } else {
        const Vec3 across = (p.p1 - p.p0).cross(q.p1 - q.p0);
        const double size = across.norm();
        if (!(size > 0.0)) continue;  // in line: whatever their other pieces say
        point.normal = across / size;
      }
      out.push_back(point);
    }
  }
  std::sort(out.begin(), out.end(),
            [](const ClashPoint& x, const ClashPoint& y) { return std::tie(x.gap, x.key) < std::tie(y.gap, y.key); });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < out.size() && kept < maxClashPoints; ++i) {
    bool known = false;
    for (std::size_t j = 0; j < kept && !known; ++j) {
      known = (out[i].onA - out[j].onA).squaredNorm() < sameClash * sameClash;
    }
    if (!known) out[kept++] = out[i];
  }
  out.resize(kept);
  std::sort(out.begin(), out.end(), [](const ClashPoint& x, const ClashPoint& y) { return x.key < y.key; });
}

}  // namespace calot
