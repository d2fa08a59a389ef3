// SPDX-License-Identifier: GPL-3.0-or-later
// Jaws that close on tissue hold it: places of the organ's skin between them are tied to the instrument (ball blocks of
// the contact problem). They slip where the pull exceeds what the grip holds, and tear out above another force.
#include <algorithm>

#include "sim/geometry/closest_point.h"
#include "sim/scene/stepper_workspace.h"

namespace calot {

using namespace stepping;

namespace {

constexpr double lockedGrip = 2.0;      ///< the ratchet holds so much harder than a hand that just closes
constexpr double searchRadius = 0.004;  ///< of a place to hold, about each station along the jaws (m)
constexpr double apart = 0.0015;        ///< places held are no nearer to each other (m)
constexpr double lost = 0.005;          ///< a place that slipped so far out of the jaws is let go (m)
/// Stations along the line between the jaws, from the tip backwards (shares of its length).
constexpr std::array<double, 3> stations{1.0, 0.65, 0.3};

double gripOf(const HandState& hand) {
  return std::clamp(1.0 - hand.realJaw / closedJaw, 0.2, 1.0) * ((hand.buttons & button::lock) != 0 ? lockedGrip : 1.0);
}

Vec3 skinPoint(const std::vector<Vec3>& skin, const std::array<std::uint32_t, 3>& node, const Vec3& weight) {
  Vec3 p = Vec3::Zero();
  for (std::size_t c = 0; c < 3; ++c) p += weight[static_cast<int>(c)] * skin[node[c]];
  return p;
}

}  // namespace

/// Places of fat that are gone are held no longer.
void Stepper::Workspace::dropLostPlaces(State& state, std::size_t hand) {
  HandState& h = state.hand[hand];
  if (h.grasped == noStructure) return;
  const Skin& held = *skinOf[h.grasped];
  std::size_t kept = 0;
  for (std::size_t a = 0; a < h.graspNode.size(); ++a) {
    const auto there = [&](std::uint32_t node) { return held.exists(static_cast<int>(node)); };
    if (!std::all_of(h.graspNode[a].begin(), h.graspNode[a].end(), there)) continue;
    h.graspNode[kept] = h.graspNode[a];
    h.graspWeight[kept] = h.graspWeight[a];
    h.graspForce[kept] = h.graspForce[a];
    h.graspPlace[kept++] = h.graspPlace[a];
  }
  h.graspNode.resize(kept);
  h.graspWeight.resize(kept);
  h.graspForce.resize(kept);
  h.graspPlace.resize(kept);
  if (kept > 0) return;
  letGo(state, hand, EventKind::graspEnd, static_cast<double>(state.clock.step - h.graspSince) * settings.step);
}

/// Ends a hold where the jaws open, or the instrument is taken away.
void Stepper::Workspace::openJaws(State& state, std::size_t hand) {
  const HandState& h = state.hand[hand];
  if (h.grasped == noStructure || (h.instrument == InstrumentKind::grasper && h.realJaw <= openJaw)) return;
  letGo(state, hand, EventKind::graspEnd, static_cast<double>(state.clock.step - h.graspSince) * settings.step);
}

/// Begins a hold where jaws that were open close on tissue.
void Stepper::Workspace::closeJaws(State& state, std::size_t hand) {
  HandState& h = state.hand[hand];
  if (h.realJaw > (h.instrument == InstrumentKind::scissors ? cuttingJaw : openJaw)) h.jawsOpened = true;
  if (h.instrument != InstrumentKind::grasper) return;
  if (h.realJaw > closedJaw || !h.jawsOpened) return;
  h.jawsOpened = false;
  const Pose tool = simulated(state, hand);
  const auto [from, to] = graspRegion(closedJaw, model.scene().hands[hand].shaftRadius).line();
  std::size_t structure = ContactBlock::nobody;
  std::vector<Vec3> held;
  for (const double station : stations) {
    const Vec3 target = tool.position + tool.orientation * Vec3(from + station * (to - from));
    double nearest = searchRadius * searchRadius;
    std::size_t nearestStructure = ContactBlock::nobody;
    Index3 triangle = Index3::Zero();
    PointTriangle best;
    for (std::size_t o = 0; o < skinOf.size(); ++o) {
      if (structure != ContactBlock::nobody && o != structure) continue;
      for (const std::uint32_t p : patchesNear(o, target, target, searchRadius)) {
        const ContactSurface& surface = skinOf[o]->surface();
        for (std::size_t t = surface.patches()[p].first; t < surface.patches()[p].last; ++t) {
          const Index3& corner = surface.triangles()[t];
          const auto at = [&](int k) -> const Vec3& { return skin[o][static_cast<std::size_t>(corner[k])]; };
          const PointTriangle found_ = closestOnTriangle(target, at(0), at(1), at(2));
          if (!(found_.squaredDistance < nearest)) continue;
          nearest = found_.squaredDistance;
          nearestStructure = o;
          triangle = corner;
          best = found_;
        }
      }
    }
    if (nearestStructure == ContactBlock::nobody) continue;
    const bool near =
        std::any_of(held.begin(), held.end(), [&](const Vec3& p) { return (p - best.point).norm() < apart; });
    if (near) continue;
    structure = nearestStructure;
    held.push_back(best.point);
    h.graspNode.push_back({static_cast<std::uint32_t>(triangle[0]), static_cast<std::uint32_t>(triangle[1]),
                           static_cast<std::uint32_t>(triangle[2])});
    h.graspWeight.push_back(best.barycentric);
    h.graspPlace.push_back(tool.orientation.conjugate() * (best.point - tool.position));
    h.graspForce.push_back(Vec3::Zero());
  }
  if (held.empty()) return;
  h.grasped = static_cast<std::uint32_t>(structure);
  h.graspSince = state.clock.step;
  h.slipping = false;
  emit(EventKind::graspBegin, hand, static_cast<std::uint16_t>(structure), h.simulatedPosition, h.realJaw);
}

void Stepper::Workspace::addHolds(const State& state) {
  for (std::size_t hand = 0; hand < handCount; ++hand) {
    const HandState& h = state.hand[hand];
    if (h.grasped == noStructure) continue;
    const Pose tool = simulated(state, hand);
    const double each = model.scene().hands[hand].slipForce * gripOf(h) / static_cast<double>(h.graspNode.size());
    for (std::size_t a = 0; a < h.graspNode.size(); ++a) {
      const Vec3 onSkin = skinPoint(skin[h.grasped], h.graspNode[a], h.graspWeight[a]);
      const Vec3 inJaws = tool.position + tool.orientation * h.graspPlace[a];
      ContactBlock block;
      block.kind = BlockKind::ball;
      block.limit = each;
      block.hand = hand;
      block.body = model.structures()[h.grasped].body;
      block.structure = h.grasped;
      block.anchor = a;
      block.place =
          skinOf[h.grasped]->influence({static_cast<int>(h.graspNode[a][0]), static_cast<int>(h.graspNode[a][1]),
                                        static_cast<int>(h.graspNode[a][2])},
                                       h.graspWeight[a]);
      for (std::size_t k = 0; k < 3; ++k) {
        block.direction[k] = Vec3::Unit(static_cast<int>(k));
        block.gap[k] = inJaws[static_cast<int>(k)] - onSkin[static_cast<int>(k)];
        block.tool[k] = toolRow(model.scene().hands[hand].port, tool, inJaws, block.direction[k]);
      }
      blocks.push_back(block);
    }
  }
}

void Stepper::Workspace::letGo(State& state, std::size_t hand, EventKind why, double value) {
  HandState& h = state.hand[hand];
  emit(why, hand, static_cast<std::uint16_t>(h.grasped), h.simulatedPosition, value);
  h.grasped = noStructure;
  h.slipping = false;
  h.graspNode.clear();
  h.graspWeight.clear();
  h.graspPlace.clear();
  h.graspForce.clear();
  // Jaws may have sunk into what they held.
  withdraw(state, hand);
}

/// After the step: tissue that tore or slipped. @pre refreshBounds() since organs moved
void Stepper::Workspace::finishHolds(State& state) {
  for (std::size_t hand = 0; hand < handCount; ++hand) {
    HandState& h = state.hand[hand];
    HandResult& out = result.hand[hand];
    out.grasping = h.grasped == noStructure ? 0 : 1U << h.grasped;
    out.graspForce = 0.0;
    if (h.grasped == noStructure) continue;
    const HandDescription& description = model.scene().hands[hand];
    Vec3 pull = Vec3::Zero();
    for (const Vec3& f : h.graspForce) pull += f;
    out.graspForce = pull.norm();
    if (out.graspForce > description.tearForce) {
      if (h.grasped < model.organs().size()) perforate(state, h.grasped, h.simulatedPosition, 0.0);
      letGo(state, hand, EventKind::tissueTear, out.graspForce);
      continue;
    }
    const double each = description.slipForce * gripOf(h) / static_cast<double>(h.graspNode.size());
    const Pose tool = simulated(state, hand);
    const auto [from, to] = graspRegion(closedJaw, description.shaftRadius).line();
    bool slipping = false;
    std::size_t kept = 0;
    for (std::size_t a = 0; a < h.graspNode.size(); ++a) {
      Vec3 place = h.graspPlace[a];
      bool gone = false;
      if (h.graspForce[a].norm() >= each * (1.0 - 1e-9)) {
        slipping = true;
        place = tool.orientation.conjugate() *
                (skinPoint(skin[h.grasped], h.graspNode[a], h.graspWeight[a]) - tool.position);
        const Vec3 onLine = from + closestOnSegment(place, from, to) * (to - from);
        gone = (place - onLine).norm() > searchRadius + lost;
      }
      if (gone) continue;
      h.graspNode[kept] = h.graspNode[a];
      h.graspWeight[kept] = h.graspWeight[a];
      h.graspForce[kept] = h.graspForce[a];
      h.graspPlace[kept++] = place;
    }
    h.graspNode.resize(kept);
    h.graspWeight.resize(kept);
    h.graspForce.resize(kept);
    h.graspPlace.resize(kept);
    if (slipping && !h.slipping) {
      emit(EventKind::graspSlip, hand, static_cast<std::uint16_t>(h.grasped), h.simulatedPosition, out.graspForce);
    }
    h.slipping = slipping;
    if (kept == 0) {
      letGo(state, hand, EventKind::graspEnd, static_cast<double>(state.clock.step - h.graspSince) * settings.step);
    }
  }
}

}  // namespace calot
