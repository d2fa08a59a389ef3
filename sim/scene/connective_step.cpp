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

/// Bodies that are tied together are awake together.
void Stepper::Workspace::wakeJoined(const State& state) {
  bool changed = true;
  while (changed) {
    changed = false;
    for (std::size_t c = 0; c < model.connective().size(); ++c) {
      const ConnectiveModel& tie = model.connective()[c];
      if (moved[tie.a] == moved[tie.b] || !holdsAnything(state.connective[c])) continue;
      moved[tie.a] = moved[tie.b] = true;
      changed = true;
    }
    for (const Tie& tie : model.ties()) {
      if (moved[tie.body[0]] == moved[tie.body[1]] || !(shareLeft(tie) > 0.0)) continue;
      moved[tie.body[0]] = moved[tie.body[1]] = true;
      changed = true;
    }
  }
}

/// Attachments of an organ by all tissues that join it to others. Those of lower number have moved already in this
/// step: their new velocities count.
void Stepper::Workspace::gatherAttachments(const State& state, std::size_t organ) {
  for (std::size_t c = 0; c < model.connective().size(); ++c) {
    const ConnectiveModel& tie = model.connective()[c];
    if (tie.a != organ && tie.b != organ) continue;
    const std::size_t other = tie.a == organ ? tie.b : tie.a;
    const SolidState& own = state.organ[organ];
    const SolidState& their = state.organ[other];
    const bool known = other < organ && moved[other];
    addConnectiveLoads(tie.tissue, state.connective[c], tie.a == organ ? ConnectiveSide::a : ConnectiveSide::b,
                       {own.position, own.velocity},
                       {their.position, known ? body[other]->freeVelocity() : std::span<const Vec3>(their.velocity)},
                       settings.step, attachments);
  }
}

/// Burns what the energised hooks touch, tears what is pulled too hard. @pre organs and instruments are where the step
/// leads them
void Stepper::Workspace::finishConnective(State& state) {
  burnedTissue.fill(noStructure);
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
      sweepHook(state, h);
      if (sweeps.empty()) continue;
      strands.clear();
      const std::size_t touches = burnStrands(tie.tissue, tissue, a, b, sweeps, settings.step, strands);
      out.hookTouches += static_cast<std::uint32_t>(touches);
      if (touches > 0 && burnedTissue[h] == noStructure) burnedTissue[h] = static_cast<std::uint32_t>(c);
      if (!strands.empty()) {
        emit(EventKind::strandsBurned, h, static_cast<std::uint16_t>(c), state.hand[h].simulatedPosition,
             shareOf(tie.tissue, strands));
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
    if (!frayed[c]) continue;
    disturb(state, tie.a);
    disturb(state, tie.b);
  }
}

}  // namespace calot
