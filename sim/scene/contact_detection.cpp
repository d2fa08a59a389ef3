// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a step that finds where instruments and organs may touch.
#include <cmath>

#include "sim/instruments/port.h"
#include "sim/scene/stepper_workspace.h"

namespace calot {

using namespace stepping;

namespace {

constexpr int largestAdvances = 16;  ///< conservative advancements a step

/// The contact's place on the skin in terms of the solid's nodes: corner weights times anchor weights.
SolidSolver::Impulse influence(const ShaftContact& contact, const Embedding& embedding) {
  SolidSolver::Impulse out;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const Embedding::Anchor& anchor = embedding.anchors()[static_cast<std::size_t>(contact.node[corner])];
    for (std::size_t a = 0; a < 4; ++a) {
      out.node[4 * corner + a] = anchor.node[a];
      out.weight[4 * corner + a] = contact.weight[static_cast<int>(corner)] * anchor.weight[a];
    }
  }
  out.impulse = contact.normal;
  return out;
}

}  // namespace

void Stepper::Workspace::refreshBounds(const State& state) {
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    if (bounded[o]) continue;
    model.organs()[o].embedding.map(state.organ[o].position, skin[o]);
    patchBounds(model.organs()[o].surface, skin[o], 0.0, bounds);
    broad[o]->update(bounds);
    bounded[o] = true;
  }
}

void Stepper::Workspace::patchesNear(std::size_t organ, const Box& box, std::vector<std::uint32_t>& out) {
  broad[organ]->pairs({&box, 1}, pairs);
  out.clear();
  for (const BroadPhase::Pair& p : pairs) out.push_back(p.leaf);
}

/// Least gap between a shaft and all organs, at most `reach_`. @pre refreshBounds() since organs moved
double Stepper::Workspace::gapOf(const Shaft& shaft, double reach_) {
  double least = reach_;
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    for (std::size_t k = 0; k < shaft.pieces(); ++k) {
      const auto [p0, p1] = shaft.piece(k);
      Box box;
      box.include(p0);
      box.include(p1);
      box.grow(shaft.radius + std::max(least, 0.0) + 1e-6);
      patchesNear(o, box, patches);
      if (patches.empty()) continue;
      least = leastGap(model.organs()[o].surface, skin[o], patches, p0, p1, shaft.radius, least);
    }
  }
  return least;
}

/// Conservative advancement (Mirtich 1996): the simulated tip goes towards the real one as far as free space reaches,
/// so that nothing is passed through on the way. A displacement d of the tip moves no point of the shaft by more.
void Stepper::Workspace::advanceFreely(State& state, std::size_t hand) {
  HandState& h = state.hand[hand];
  const HandDescription& description = model.scene().hands[hand];
  remaining[hand] = h.realPosition - h.simulatedPosition;
  for (int i = 0; i < largestAdvances; ++i) {
    const double left = remaining[hand].norm();
    if (!(left > 0.0)) break;
    const Shaft shaft(description.port, h.simulatedPosition, description.shaftRadius);
    const double gap = gapOf(shaft, left + 2.0 * margin);
    if (gap >= left + margin) {
      h.simulatedPosition = h.realPosition;
      remaining[hand].setZero();
      break;
    }
    if (gap <= 1.05 * margin) break;
    h.simulatedPosition += remaining[hand] * ((gap - margin) / left);
    remaining[hand] = h.realPosition - h.simulatedPosition;
  }
  const double left = remaining[hand].norm();
  share[hand] = left > largestSlide ? largestSlide / left : 1.0;
  reach[hand] = margin + std::min(left, largestSlide);
}

/// Rows of every shaft near every organ, in order of hand, organ and place.
void Stepper::Workspace::detect(const State& state) {
  rows.clear();
  for (std::size_t h = 0; h < handCount; ++h) {
    if (state.hand[h].instrument == InstrumentKind::none) continue;
    const HandDescription& description = model.scene().hands[h];
    const Shaft shaft(description.port, state.hand[h].simulatedPosition, description.shaftRadius);
    for (std::size_t o = 0; o < model.organs().size(); ++o) {
      double speed = 0.0;
      for (const Vec3& v : state.organ[o].velocity) speed = std::max(speed, v.squaredNorm());
      const double far = reach[h] + std::min(std::sqrt(speed) * settings.step, largestSlide);
      found.clear();
      for (std::size_t k = 0; k < shaft.pieces(); ++k) {
        const auto [p0, p1] = shaft.piece(k);
        Box box;
        box.include(p0);
        box.include(p1);
        box.grow(shaft.radius + far + 1e-6);
        patchesNear(o, box, patches);
        shaftContacts(model.organs()[o].surface, skin[o], patches, p0, p1, shaft.radius, far,
                      static_cast<std::uint32_t>(k), found);
      }
      for (const ShaftContact& contact : found) {
        ContactRow row;
        row.hand = h;
        row.organ = o;
        row.contact = contact;
        row.place = influence(contact, model.organs()[o].embedding);
        row.contact.key |= static_cast<std::uint64_t>(o) << 52U;
        const double s = (contact.onAxis - shaft.port).dot(shaft.axis);
        row.direction = shaftTranspose(shaft.axis, s, shaft.length, contact.normal);
        rows.push_back(row);
      }
    }
  }
}

}  // namespace calot
