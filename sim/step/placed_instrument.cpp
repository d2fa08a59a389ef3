// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/placed_instrument.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "sim/contact/contact_solver.h"
#include "sim/geometry/closest_point.h"
#include "sim/step/contact_block.h"
#include "sim/vessel/beam_state.h"

namespace calot {

namespace {

/// That jaws may sink into what they grasp (m): about the thickness of a fold of gallbladder wall. Larger: the
/// instrument sticks in tissue after release; smaller: tissue is pushed out of closing jaws. Assumed.
constexpr double graspedDepth = 0.0035;
/// The same about a clip (m): deeper than any vessel is thick. Larger changes nothing.
constexpr double crushedDepth = 0.02;

/// Are these the jaws of an applier that has closed, and not opened since, about a clip of this vessel? They crush what
/// they clip; blunt bodies that closed on a tube which cannot give way would throw it about.
bool isClosedOnClip(const Model& model, const State& state, const InstrumentState& applier, std::size_t structure) {
  const StructureModel& s = model.structures()[structure];
  if (s.kind != tissueId<VesselTissue> || applier.jawsOpened) return false;
  if (instrumentOf(applier.kind).action != InstrumentAction::clip) return false;
  const BeamModel& beams = model.vesselTrees()[s.index].beams;
  const BeamState& vessels = state.vessel[s.index];
  const double reach = 1.5 * model.scene().clip.legs;
  for (std::size_t c = 0; c < vessels.clips(); ++c) {
    if (vessels.clipBranch[c] != s.branch) continue;
    const Vec3 where = centreLine(beams, vessels, pointAt(beams, s.branch, vessels.clipPlace[c])).position;
    if ((where - applier.position).squaredNorm() < reach * reach) return true;
  }
  return false;
}

}  // namespace

double currentPace(const CauteryDescription& cautery, const HandState& hand) {
  if (instrumentOf(hand.instrument.kind).action != InstrumentAction::burn) return 0.0;
  if ((hand.input.buttons & button::cutPedal) != 0) return 1.0;
  return (hand.input.buttons & button::coagulatePedal) != 0 ? cautery.coagulationPace : 0.0;
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
  if (isClosedOnClip(model, state, h.instrument, structure)) return crushedDepth;
  return h.grasp.structure == structure ? graspedDepth : 0.0;
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

namespace {

constexpr int maxPasses = 6;              ///< of one search; more find nothing better (measured on folds)
constexpr double toleratedDepth = 2e-5;   ///< m; deeper is worth another pass
constexpr double maxDisplacement = 0.02;  ///< of a tip, by all passes of one search (m): the first may lead astray
/// The longest way out over the depth: tissue that presses from two sides a tenth of a millimetre too close is no
/// reason to leave its fold. Assumed; measured on folds.
constexpr double wayForDepth = 10.0;
constexpr double pinchedCosine = -0.25;  ///< normals that face each other more than this press from two sides
/// Along the shaft (m), where the nearest way out fails. Assumed.
constexpr std::array<double, 4> retreats{0.002, 0.005, 0.01, 0.02};

}  // namespace

void instrumentContacts(const Model& model, const Surfaces& surfaces, const State& state, std::size_t hand,
                        const PlacedInstrument& instrument, std::size_t structure, double far, Surfaces::Search& search,
                        std::vector<SurfaceContact>& out) {
  out.clear();
  for (const Capsule& c : instrument.capsule) {
    // In its dimple the skin has given way: the capsule meets the mesh that much farther out.
    const Vec3 dimple = dimpleOf(state.hand[hand].touches, structure, c.piece);
    const Vec3 p0 = c.p0 + dimple;
    const Vec3 p1 = c.p1 + dimple;
    const std::span<const std::uint32_t> near =
        surfaces.patchesNear(structure, p0, p1, capsuleSearch(c.radius, far), search);
    const std::size_t first = out.size();
    capsuleContacts(surfaces.mesh(structure), surfaces.points(structure), near, p0, p1, c.radius, far, c.piece, out);
    const double allowed = allowedDepth(model, state, hand, c, structure);
    if (!(allowed > 0.0)) continue;
    const auto from = out.begin() + static_cast<std::ptrdiff_t>(first);
    for (auto contact = from; contact != out.end(); ++contact) contact->gap += allowed;
    out.erase(std::remove_if(from, out.end(), [far](const SurfaceContact& x) { return !(x.gap < far); }), out.end());
  }
}

/// The deepest that the placed instrument stands in any structure or in the other instrument, and every point where it
/// does.
double PenetrationResolver::findInside(const Surfaces& surfaces, const State& state, std::size_t hand,
                                       const Pose& pose) {
  const Vec3& port = model_.scene().hands[hand].port;
  inside_.clear();
  double depth = 0.0;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    instrumentContacts(model_, surfaces, state, hand, instrument_, s, 0.0, search_, found_);
    for (const SurfaceContact& contact : found_) {
      if (!(contact.gap < 0.0)) continue;
      inside_.push_back({toolRow(port, pose, contact.onAxis, contact.normal), contact.normal, contact.gap});
      depth = std::max(depth, -contact.gap);
    }
  }
  clashPoints(instrument_, other_, 0.0, clash_);
  for (const ClashPoint& point : clash_) {
    inside_.push_back({toolRow(port, pose, point.onA, point.normal), point.normal, point.gap});
    depth = std::max(depth, -point.gap);
  }
  return depth;
}

/// The shortest motion of the instrument that leaves every point in `inside_`: a small complementarity problem without
/// tissue. Tip motion costs as its square; a roll as the motion of a point 5 mm from the axis.
ToolRow PenetrationResolver::minWayOut() const {
  constexpr double arm2 = 0.005 * 0.005;
  const std::size_t n = inside_.size();
  const std::vector<double> none(n, 0.0);
  const std::vector<BlockKind> kind(n, BlockKind::unilateral);
  std::vector<double> w(n * n);
  std::vector<double> free(n);
  std::vector<double> gaps(n);
  std::vector<double> force(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    free[i] = inside_[i].gap;
    for (std::size_t j = 0; j < n; ++j) {
      w[i * n + j] =
          inside_[i].row.head<3>().dot(inside_[j].row.head<3>()) + inside_[i].row[3] * inside_[j].row[3] / arm2;
    }
    w[i * n + i] *= 1.01;  // rows that repeat each other stay solvable
  }
  sweepContacts({kind, none, w, free}, force, gaps, 0.1 * toleratedDepth, 50);
  ToolRow q = ToolRow::Zero();
  for (std::size_t i = 0; i < n; ++i) q += force[i] * inside_[i].row;
  q[3] /= arm2;
  return q;
}

/// Follows minWayOut() from a pose, pass by pass. Keeps the best pose met: folds and pinches may lead a pass
/// astray.
PenetrationResolver::Outcome PenetrationResolver::search(const Surfaces& surfaces, const State& state, std::size_t hand,
                                                         Pose pose) {
  const InstrumentState& instrument = state.hand[hand].instrument;
  const HandDescription& description = model_.scene().hands[hand];
  Outcome best{pose, 1e300, false};
  double gone = 0.0;
  double mayGo = maxDisplacement;
  for (int pass = 0;; ++pass) {
    instrument_.place(description, instrument.kind, pose, instrument.jaw);
    const double depth = findInside(surfaces, state, hand, pose);
    if (pass == 0) mayGo = std::min(mayGo, wayForDepth * depth);
    if (depth < best.depth) {
      best = {pose, depth, false};
      for (const Inside& a : inside_) {
        for (const Inside& b : inside_) best.pinched = best.pinched || a.normal.dot(b.normal) < pinchedCosine;
      }
    }
    if (depth <= toleratedDepth || pass >= maxPasses || gone >= mayGo) return best;
    const ToolRow q = minWayOut();
    Vec3 way = q.head<3>();
    const double size = way.norm();
    const double limit = std::min(mayGo - gone, 3.0 * depth);
    if (size > limit) way *= limit / size;
    gone += std::min(size, limit);
    pose = movedTool(description.port, pose, way, std::clamp(q[3], -0.2, 0.2));
  }
}

void PenetrationResolver::run(const Surfaces& surfaces, std::size_t hand, State& state, ContactResult& contact) {
  InstrumentState& instrument = state.hand[hand].instrument;
  if (instrument.kind == InstrumentKind::none) return;
  const Vec3& port = model_.scene().hands[hand].port;
  const Pose from = simulatedPose(instrument);
  other_.place(model_.scene().hands[1 - hand], state.hand[1 - hand].instrument);
  Outcome best = search(surfaces, state, hand, from);
  const double longest = wayForDepth * best.depth;
  for (const double retreat : retreats) {
    if (best.depth <= toleratedDepth || retreat > longest) break;
    const Vec3 back = from.orientation * Vec3(0.0, 0.0, -retreat);
    const Outcome other = search(surfaces, state, hand, movedTool(port, from, back, 0.0));
    if (other.depth < best.depth) best = other;
  }
  instrument.position = best.pose.position;
  instrument.orientation = best.pose.orientation;
  double& left = best.pinched ? contact.pinchedDepth : contact.maxDepth;
  left = std::max(left, best.depth);
}

}  // namespace calot
