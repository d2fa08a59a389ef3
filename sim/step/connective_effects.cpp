// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/connective_effects.h"

#include <algorithm>

namespace calot {

namespace {

double shareOf(const ConnectiveTissue& tissue, std::span<const std::uint32_t> strands) {
  double area = 0.0;
  for (const std::uint32_t s : strands) area += tissue.strands()[s].area;
  return area / tissue.area();
}

}  // namespace

void ConnectiveEffects::run(const HookSweeps& sweeps, const std::array<HookTouches, handCount>& touches, Bodies& bodies,
                            State& state, Activity& activity, StepResult& result, StepLog& log) {
  for (std::size_t c = 0; c < model_.connective().size(); ++c) {
    const ConnectiveModel& tie = model_.connective()[c];
    ConnectiveState& tissue = state.connective[c];
    ConnectiveResult& out = result.connective[c];
    const std::vector<Vec3>& a = state.organ[tie.a].position;
    const std::vector<Vec3>& b = state.organ[tie.b].position;
    const bool held = holdsAnything(tissue);
    out.hookTouches = 0;
    for (std::size_t h = 0; h < handCount; ++h) {
      if (touches[h].strand[c].empty()) continue;
      strands_.clear();
      const double seconds = bodies.step() * sweeps[h].pace * touches[h].intensity(model_.scene().cautery.spot);
      burnStrands(tie.tissue, tissue, touches[h].strand[c], seconds, strands_);
      out.hookTouches += static_cast<std::uint32_t>(touches[h].strand[c].size());
      if (!strands_.empty()) {
        log.emit(EventKind::strandsBurned, h, c, state.hand[h].simulatedPosition, shareOf(tie.tissue, strands_));
      }
    }
    strands_.clear();
    const DamageReport damage = advanceDamage(tie.tissue, tissue, a, b, strands_);
    out.maxPull = damage.maxTraction;
    if (!strands_.empty()) {
      log.emit(EventKind::strandsTorn, StepLog::noHand, c, tie.tissue.strands()[strands_[0]].a.of(a),
               shareOf(tie.tissue, strands_));
    }
    const ConnectiveShares shares = sharesOf(tie.tissue, tissue);
    out.attached = shares.attached;
    out.burned = shares.burned;
    out.torn = shares.torn;
    activity.frayed[c] = out.hookTouches > 0 || damage.grown;
    if (held && !holdsAnything(tissue)) {
      log.emit(EventKind::connectiveFreed, StepLog::noHand, c, Vec3::Zero(), shares.torn);
    }
    if (!activity.frayed[c]) continue;
    // What was released moves.
    activity.disturb(bodies, state, tie.a);
    activity.disturb(bodies, state, tie.b);
  }
}

}  // namespace calot
