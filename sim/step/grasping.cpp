// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/placed_instrument.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "sim/geometry/closest_point.h"
#include "sim/instruments/instrument_shape.h"
#include "sim/step/tissue_effects.h"

namespace calot {

namespace {

/// The ratchet holds this much harder than a hand that just closes. Larger: tissue tears before it slips. Assumed.
constexpr double ratchetGrip = 2.0;
constexpr double weakestGrip = 0.2;  ///< share of the slip force that barely closed jaws hold. Assumed
/// Search radius for a point to grasp, about each station along the jaws (m): reaches all that lies between them.
constexpr double searchRadius = 0.004;
/// Skin that jaws press on rises between them; that of a mesh does not, and is taken when it is no farther before the
/// tips (m). Larger: tissue is taken without being touched; smaller: jaws close on nothing. Assumed.
constexpr double foldRise = 0.001;
constexpr double minSpacing = 0.0015;   ///< between grasped points (m): nearer ones repeat each other's rows
constexpr double lostDistance = 0.005;  ///< a point that slipped so far out of the jaws is released (m)
/// Stations along the line between the jaws, from the tip backwards (shares of its length).
constexpr std::array<double, 3> stations{1.0, 0.65, 0.3};

double gripOf(const HandState& hand) {
  return std::clamp(1.0 - hand.input.jaw / instrumentOf(hand.instrument.kind).jaw.closed, weakestGrip, 1.0) *
         ((hand.input.buttons & button::lock) != 0 ? ratchetGrip : 1.0);
}

Vec3 skinPoint(const std::vector<Vec3>& skin, const std::array<std::uint32_t, 3>& node, const Vec3& weight) {
  Vec3 p = Vec3::Zero();
  for (std::size_t c = 0; c < 3; ++c) p += weight[static_cast<int>(c)] * skin[node[c]];
  return p;
}

/// The point of a polygon that is nearest to p. @param[in,out] least squared distance that it has to beat (m^2)
Vec3 nearestIn(const SmallPolygon& polygon, const Vec3& p, double& least) {
  Vec3 nearest = Vec3::Zero();
  for (std::size_t k = 2; k < polygon.count; ++k) {
    const PointTriangle found = closestOnTriangle(p, polygon.corner[0], polygon.corner[k - 1], polygon.corner[k]);
    if (!(found.squaredDistance < least)) continue;
    least = found.squaredDistance;
    nearest = found.point;
  }
  return nearest;
}

/// Keeps the first `count` grasped points.
void resizeGrasp(GraspState& grasp, std::size_t count) {
  grasp.node.resize(count);
  grasp.weight.resize(count);
  grasp.force.resize(count);
  grasp.place.resize(count);
}

/// Moves grasped point `from` to `to`. @pre to <= from
void moveGrasp(GraspState& grasp, std::size_t from, std::size_t to) {
  grasp.node[to] = grasp.node[from];
  grasp.weight[to] = grasp.weight[from];
  grasp.force[to] = grasp.force[from];
  grasp.place[to] = grasp.place[from];
}

}  // namespace

void Grasping::end(const Surfaces& surfaces, std::size_t hand, EventKind why, double value, State& state, StepLog& log,
                   ContactResult& contact) {
  HandState& h = state.hand[hand];
  log.emit(why, hand, h.grasp.structure, h.instrument.position, value);
  h.grasp.structure = noStructure;
  h.grasp.slipping = false;
  resizeGrasp(h.grasp, 0);
  // Jaws may have sunk into what they held.
  resolver_.run(surfaces, hand, state, contact);
}

void Grasping::removeStaleGrasps(const Surfaces& surfaces, std::size_t hand, State& state, StepLog& log,
                                 ContactResult& contact) {
  GraspState& grasp = state.hand[hand].grasp;
  if (grasp.structure == noStructure) return;
  const Skin& held = surfaces.skin(grasp.structure);
  std::size_t kept = 0;
  for (std::size_t a = 0; a < grasp.node.size(); ++a) {
    const auto exists = [&](std::uint32_t node) { return held.exists(static_cast<int>(node)); };
    if (std::all_of(grasp.node[a].begin(), grasp.node[a].end(), exists)) moveGrasp(grasp, a, kept++);
  }
  resizeGrasp(grasp, kept);
  if (kept > 0) return;
  end(surfaces, hand, EventKind::graspEnd, heldFor(grasp, state), state, log, contact);
}

void Grasping::release(const Surfaces& surfaces, State& state, StepLog& log, ContactResult& contact) {
  for (std::size_t hand = 0; hand < handCount; ++hand) removeStaleGrasps(surfaces, hand, state, log, contact);
  for (std::size_t hand = 0; hand < handCount; ++hand) {
    const HandState& h = state.hand[hand];
    const InstrumentDefinition& instrument = instrumentOf(h.instrument.kind);
    const bool holds = instrument.action == InstrumentAction::grasp && h.input.jaw <= instrument.jaw.opened;
    if (h.grasp.structure == noStructure || holds) continue;
    end(surfaces, hand, EventKind::graspEnd, heldFor(h.grasp, state), state, log, contact);
  }
}

void Grasping::close(const Surfaces& surfaces, State& state, StepLog& log) const {
  for (std::size_t hand = 0; hand < handCount; ++hand) closeOne(surfaces, hand, state, log);
}

void Grasping::closeOne(const Surfaces& surfaces, std::size_t hand, State& state, StepLog& log) const {
  HandState& h = state.hand[hand];
  const InstrumentDefinition& instrument = instrumentOf(h.instrument.kind);
  if (h.input.jaw > instrument.jaw.opened) h.instrument.jawsOpened = true;
  if (instrument.action != InstrumentAction::grasp) return;
  if (h.input.jaw > instrument.jaw.closed || !h.instrument.jawsOpened) return;
  h.instrument.jawsOpened = false;
  const Pose tool = simulatedPose(h.instrument);
  const Quat toJaws = tool.orientation.conjugate();
  const double shaftRadius = model_.scene().hands[hand].shaftRadius;
  const auto [from, to] = graspLine(instrument, shaftRadius);
  const JawSpace space = jawSpace(instrument, shaftRadius, to[2] - from[2], foldRise);
  std::optional<std::size_t> structure;
  Surfaces::Search search;
  std::vector<Vec3> held;
  for (const double station : stations) {
    const Vec3 target = tool.position + tool.orientation * Vec3(from + station * (to - from));
    const Vec3 inJaws = from + station * (to - from);
    double nearest = searchRadius * searchRadius;
    std::optional<std::size_t> nearestStructure;
    Index3 triangle = Index3::Zero();
    PointTriangle best;
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
      if (structure && s != *structure) continue;
      for (const std::uint32_t p : surfaces.patchesNear(s, target, target, searchRadius, search)) {
        const ContactSurface& surface = surfaces.mesh(s);
        for (std::size_t t = surface.patches()[p].first; t < surface.patches()[p].last; ++t) {
          const Index3& corner = surface.triangles()[t];
          const auto at = [&](int k) -> const Vec3& { return surfaces.points(s)[static_cast<std::size_t>(corner[k])]; };
          if (!(closestOnTriangle(target, at(0), at(1), at(2)).squaredDistance < nearest)) continue;
          const auto local = [&](int k) { return Vec3(toJaws * (at(k) - tool.position)); };
          const double least = nearest;
          const Vec3 point = nearestIn(between(space, local(0), local(1), local(2)), inJaws, nearest);
          if (!(nearest < least)) continue;
          nearestStructure = s;
          triangle = corner;
          best = closestOnTriangle(tool.position + tool.orientation * point, at(0), at(1), at(2));
        }
      }
    }
    if (!nearestStructure) continue;
    const bool near =
        std::any_of(held.begin(), held.end(), [&](const Vec3& p) { return (p - best.point).norm() < minSpacing; });
    if (near) continue;
    structure = nearestStructure;
    held.push_back(best.point);
    h.grasp.node.push_back({static_cast<std::uint32_t>(triangle[0]), static_cast<std::uint32_t>(triangle[1]),
                            static_cast<std::uint32_t>(triangle[2])});
    h.grasp.weight.push_back(best.barycentric);
    h.grasp.place.push_back(tool.orientation.conjugate() * (best.point - tool.position));
    h.grasp.force.push_back(Vec3::Zero());
  }
  if (held.empty()) return;
  h.grasp.structure = static_cast<std::uint32_t>(*structure);
  h.grasp.since = state.clock.step;
  h.grasp.slipping = false;
  log.emit(EventKind::graspBegin, hand, *structure, h.instrument.position, h.input.jaw);
}

void Grasping::addBlocks(const Surfaces& surfaces, const State& state, std::vector<ContactBlock>& blocks) const {
  for (std::size_t hand = 0; hand < handCount; ++hand) {
    const HandState& h = state.hand[hand];
    const GraspState& grasp = h.grasp;
    if (grasp.structure == noStructure) continue;
    const HandDescription& description = model_.scene().hands[hand];
    const Pose tool = simulatedPose(h.instrument);
    const double each = description.slipForce * gripOf(h) / static_cast<double>(grasp.node.size());
    for (std::size_t a = 0; a < grasp.node.size(); ++a) {
      const Vec3 onSkin = skinPoint(surfaces.points(grasp.structure), grasp.node[a], grasp.weight[a]);
      const Vec3 inJaws = tool.position + tool.orientation * grasp.place[a];
      ContactBlock block;
      block.kind = BlockKind::bilateral;
      block.limit = each;
      Grasped grasped;
      grasped.tool.hand = hand;
      grasped.anchor = a;
      grasped.tissue.body = model_.structures()[grasp.structure].body;
      grasped.tissue.place = surfaces.skin(grasp.structure)
                                 .influence({static_cast<int>(grasp.node[a][0]), static_cast<int>(grasp.node[a][1]),
                                             static_cast<int>(grasp.node[a][2])},
                                            grasp.weight[a]);
      for (std::size_t k = 0; k < 3; ++k) {
        block.direction[k] = Vec3::Unit(static_cast<int>(k));
        block.gap[k] = inJaws[static_cast<int>(k)] - onSkin[static_cast<int>(k)];
        grasped.tool.row[k] = toolRow(description.port, tool, inJaws, block.direction[k]);
      }
      block.of = std::move(grasped);
      blocks.push_back(std::move(block));
    }
  }
}

bool Grasping::slip(const Surfaces& surfaces, std::size_t hand, State& state) const {
  HandState& h = state.hand[hand];
  GraspState& grasp = h.grasp;
  const HandDescription& description = model_.scene().hands[hand];
  const double each = description.slipForce * gripOf(h) / static_cast<double>(grasp.node.size());
  const Pose tool = simulatedPose(h.instrument);
  const auto [from, to] = graspLine(instrumentOf(h.instrument.kind), description.shaftRadius);
  bool slipping = false;
  std::size_t kept = 0;
  for (std::size_t a = 0; a < grasp.node.size(); ++a) {
    Vec3 place = grasp.place[a];
    bool gone = false;
    if (grasp.force[a].norm() >= each * (1.0 - 1e-9)) {
      slipping = true;
      place = tool.orientation.conjugate() *
              (skinPoint(surfaces.points(grasp.structure), grasp.node[a], grasp.weight[a]) - tool.position);
      const Vec3 onLine = from + closestOnSegment(place, from, to) * (to - from);
      gone = (place - onLine).norm() > searchRadius + lostDistance;
    }
    if (gone) continue;
    moveGrasp(grasp, a, kept);
    grasp.place[kept++] = place;
  }
  resizeGrasp(grasp, kept);
  return slipping;
}

void Grasping::settle(const Surfaces& surfaces, State& state, Activity& activity, StepResult& result, StepLog& log) {
  for (std::size_t hand = 0; hand < handCount; ++hand) {
    HandState& h = state.hand[hand];
    GraspState& grasp = h.grasp;
    HandResult& out = result.hand[hand];
    out.grasping = grasp.structure == noStructure ? 0 : 1U << grasp.structure;
    out.graspForce = 0.0;
    out.gripForce = 0.0;
    if (grasp.structure == noStructure) continue;
    out.gripForce = model_.scene().hands[hand].slipForce * gripOf(h);
    Vec3 pull = Vec3::Zero();
    for (const Vec3& f : grasp.force) pull += f;
    out.graspForce = pull.norm();
    if (out.graspForce > model_.scene().hands[hand].tearForce) {
      if (grasp.structure < model_.organs().size())
        perforateOrgan(model_, grasp.structure, h.instrument.position, 0.0, state, activity, log);
      end(surfaces, hand, EventKind::tissueTear, out.graspForce, state, log, result.contact);
      continue;
    }
    const bool slipping = slip(surfaces, hand, state);
    if (slipping && !grasp.slipping) {
      log.emit(EventKind::graspSlip, hand, grasp.structure, h.instrument.position, out.graspForce);
    }
    grasp.slipping = slipping;
    if (grasp.node.empty()) {
      end(surfaces, hand, EventKind::graspEnd, heldFor(grasp, state), state, log, result.contact);
    }
  }
}

}  // namespace calot
