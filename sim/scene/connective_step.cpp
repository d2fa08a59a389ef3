// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a step that ties organs together by connective tissue, burns and tears it.
#include <algorithm>

#include "sim/scene/stepper_workspace.h"

namespace calot {

namespace {

bool holdsAnything(const ConnectiveState& state) {
  return std::find(state.condition.begin(), state.condition.end(), StrandCondition::attached) != state.condition.end();
}

double shareOf(const ConnectiveTissue& tissue, std::span<const std::uint32_t> strands) {
  double area = 0.0;
  for (const std::uint32_t s : strands) area += tissue.strands()[s].area;
  return area / tissue.area();
}

}  // namespace

/// Organs that are tied together are awake together.
void Stepper::Workspace::wakeJoined(const State& state) {
  bool changed = !model.connective().empty();
  while (changed) {
    changed = false;
    for (std::size_t c = 0; c < model.connective().size(); ++c) {
      const ConnectiveModel& tie = model.connective()[c];
      if (moved[tie.a] == moved[tie.b] || !holdsAnything(state.connective[c])) continue;
      moved[tie.a] = moved[tie.b] = true;
      changed = true;
    }
  }
}

/// Attachments of an organ by all tissues that join it to others. Those of lower number have moved already in this
/// step: their new velocities count.
void Stepper::Workspace::gatherAttachments(const State& state, std::size_t organ) {
  attachments.clear();
  for (std::size_t c = 0; c < model.connective().size(); ++c) {
    const ConnectiveModel& tie = model.connective()[c];
    if (tie.a != organ && tie.b != organ) continue;
    const std::size_t other = tie.a == organ ? tie.b : tie.a;
    const SolidState& own = state.organ[organ];
    const SolidState& their = state.organ[other];
    const bool known = other < organ && moved[other];
    addConnectiveLoads(tie.tissue, state.connective[c], tie.a == organ ? ConnectiveSide::a : ConnectiveSide::b,
                       {own.position, own.velocity},
                       {their.position, known ? solver[other].freeVelocity() : their.velocity}, settings.step,
                       attachments);
  }
}

/// Burns what the energised hooks touch, tears what is pulled too hard. @pre organs and instruments are where the step
/// leads them
void Stepper::Workspace::finishConnective(State& state) {
  for (std::size_t c = 0; c < model.connective().size(); ++c) {
    const ConnectiveModel& tie = model.connective()[c];
    ConnectiveState& tissue = state.connective[c];
    ConnectiveResult& out = result.connective[c];
    const std::vector<Vec3>& a = state.organ[tie.a].position;
    const std::vector<Vec3>& b = state.organ[tie.b].position;
    const bool held = holdsAnything(tissue);
    out.hookTouches = 0;
    frayed[c] = false;
    for (std::size_t h = 0; h < handCount; ++h) {
      const HandState& hand = state.hand[h];
      const bool energised = (hand.buttons & (button::cutPedal | button::coagulatePedal)) != 0;
      if (hand.instrument != InstrumentKind::hook || !energised) continue;
      const HandDescription& description = model.scene().hands[h];
      const Pose now = simulated(state, h);
      const InstrumentShape hook =
          instrumentShape(hand.instrument, hand.jaw, description.shaftRadius, (now.position - description.port).norm());
      const InstrumentShape before = placed(hook, poseBefore[h]);
      const InstrumentShape after = placed(hook, now);
      sweeps.clear();
      strands.clear();
      for (std::size_t k = 0; k < after.capsules().size(); ++k) {
        const Capsule& from = before.capsules()[k];
        const Capsule& to = after.capsules()[k];
        if (to.part != Capsule::Part::hook) continue;
        sweeps.push_back({{from.p0, from.p1}, {to.p0, to.p1}, to.radius});
      }
      out.hookTouches +=
          static_cast<std::uint32_t>(burnStrands(tie.tissue, tissue, a, b, sweeps, settings.step, strands));
      if (!strands.empty()) {
        emit(EventKind::strandsBurned, h, static_cast<std::uint16_t>(c), now.position, shareOf(tie.tissue, strands));
      }
    }
    strands.clear();
    out.largestPull = tearOverstretched(tie.tissue, tissue, a, b, strands);
    if (!strands.empty()) {
      emit(EventKind::strandsTorn, 255, static_cast<std::uint16_t>(c), tie.tissue.strands()[strands[0]].a.of(a),
           shareOf(tie.tissue, strands));
    }
    const ConnectiveShares shares = sharesOf(tie.tissue, tissue);
    out.attached = shares.attached;
    out.burned = shares.burned;
    out.torn = shares.torn;
    frayed[c] = out.hookTouches > 0 || !strands.empty();
    if (held && !holdsAnything(tissue)) {
      emit(EventKind::connectiveFreed, 255, static_cast<std::uint16_t>(c), Vec3::Zero(), shares.torn);
    }
    // What was let loose moves.
    if (frayed[c]) state.organ[tie.a].quietSteps = state.organ[tie.b].quietSteps = 0;
  }
}

}  // namespace calot
