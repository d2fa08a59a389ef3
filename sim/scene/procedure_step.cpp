// SPDX-License-Identifier: GPL-3.0-or-later
// What the step did, as a step of the procedure: phase, critical view of safety, errors (docs/procedure.md).
#include <algorithm>

#include "sim/scene/stepper_workspace.h"

namespace calot {

using namespace stepping;

namespace {

// Critical view of safety: one point and two points of each criterion.
constexpr double clearedOne = 0.35;  ///< share of the fat in the triangle that may be left
constexpr double clearedTwo = 0.10;
constexpr double freedOne = 0.5;  ///< share of the bed's lower third that may still be attached
constexpr double freedTwo = 0.05;
constexpr double bareShare = 0.2;  ///< share of the fat close around a vessel that may be left where it counts as bare

bool opens(EventKind kind) {
  return kind == EventKind::vesselCut || kind == EventKind::vesselBurned || kind == EventKind::vesselTorn;
}

}  // namespace

/// Share that is left of the fat in a region.
double Stepper::Workspace::leftIn(std::size_t region) const {
  const std::size_t f = model.procedure().fat;
  if (f == ProcedureModel::none || region == ProcedureModel::none || !(wholeRegion[region] > 0.0)) return 0.0;
  return fatMotion[f]->fat().volume().inRegion(region) / wholeRegion[region];
}

/// Share of the bed's lower third that is attached.
double Stepper::Workspace::lowerThirdAttached(const State& state) const {
  const ProcedureModel& procedure = model.procedure();
  if (procedure.bed == ProcedureModel::none) return 0.0;
  const std::vector<Strand>& bed = model.connective()[procedure.bed].tissue.strands();
  double all = 0.0;
  double attached = 0.0;
  for (const std::uint32_t s : procedure.lowerThird) {
    all += bed[s].area;
    if (state.connective[procedure.bed].condition[s] == StrandCondition::attached) attached += bed[s].area;
  }
  return all > 0.0 ? attached / all : 0.0;
}

bool Stepper::Workspace::isParted(const State& state, std::size_t structure) const {
  const StructureModel& s = model.structures()[structure];
  const BeamModel::Branch& branch = model.vesselTrees()[s.index].beams.branches()[s.branch];
  const auto first = state.vessel[s.index].parting.begin() + static_cast<std::ptrdiff_t>(branch.firstElement);
  return std::any_of(first, first + static_cast<std::ptrdiff_t>(branch.elements()),
                     [](Parting p) { return p != Parting::none; });
}

void Stepper::Workspace::judgeView(const State& state, ProcedureState& out) const {
  const ProcedureModel& procedure = model.procedure();
  const double left = leftIn(procedure.clearRegion);
  out.triangleCleared = left <= clearedTwo ? 2 : left <= clearedOne ? 1 : 0;
  const double attached = lowerThirdAttached(state);
  out.lowerThirdFreed = attached <= freedTwo ? 2 : attached <= freedOne ? 1 : 0;
  std::size_t seen = 0;
  for (const ProcedureModel::Divide& vessel : procedure.divide) {
    if (leftIn(vessel.coverRegion) <= bareShare && !isParted(state, vessel.structure)) ++seen;
  }
  out.twoStructures = seen == procedure.divide.size() ? 2 : seen > 0 ? 1 : 0;
}

/// @pre all else of the step is done
void Stepper::Workspace::finishProcedure(State& state) {
  if (state.procedure.empty()) return;
  const ProcedureModel& procedure = model.procedure();
  ProcedureState& now = state.procedure[0];
  const auto isOneOf = [](const std::vector<std::size_t>& structures, std::uint16_t subject) {
    return std::find(structures.begin(), structures.end(), subject) != structures.end();
  };
  std::vector<std::size_t> divided;
  for (const ProcedureModel::Divide& vessel : procedure.divide) divided.push_back(vessel.structure);
  const bool allParted = std::all_of(divided.begin(), divided.end(), [&](std::size_t s) { return isParted(state, s); });

  if (!now.frozen) judgeView(state, now);
  Phase phase = now.phase;
  const std::size_t told = result.events.size();
  for (std::size_t i = 0; i < told; ++i) {
    const Event event = result.events[i];
    switch (event.kind) {
      case EventKind::clipSet:
        now.frozen = true;
        phase = Phase::clipping;
        break;
      case EventKind::clipDropped:
        phase = Phase::clipping;
        ++now.errors;
        break;
      case EventKind::clipHalfOn:
      case EventKind::clipOnClip:
      case EventKind::clipTooNear:
      case EventKind::cutThroughClip:
      case EventKind::organPerforated:
      case EventKind::tooFewClips:
        ++now.errors;
        break;
      case EventKind::vesselCut:
        phase = Phase::cutting;
        break;
      case EventKind::vesselBurned:
      case EventKind::vesselTorn:
        if (isOneOf(divided, event.subject)) ++now.errors;
        break;
      case EventKind::strandsBurned:
      case EventKind::strandsTorn:
        // Before the first clip the bed's lower third is freed to see what enters the gallbladder.
        phase = now.frozen || procedure.divide.empty() ? Phase::dissection : Phase::identification;
        break;
      default:
        break;
    }
    if ((event.kind == EventKind::clipSet || opens(event.kind)) && isOneOf(procedure.spare, event.subject)) {
      ++now.criticalErrors;
      emit(EventKind::criticalError, event.hand, event.subject, event.position, static_cast<double>(event.kind));
    }
  }
  if (procedure.fat != ProcedureModel::none && result.fat[procedure.fat].carved > 0.0) {
    phase = allParted ? Phase::dissection : Phase::identification;
  }
  const bool freed = procedure.bed == ProcedureModel::none || !(result.connective[procedure.bed].attached > 0.0);
  if (allParted && freed) phase = Phase::done;
  if (phase != now.phase) {
    emit(EventKind::phaseBegin, 255, static_cast<std::uint16_t>(phase), Vec3::Zero(), static_cast<double>(now.phase));
    now.phase = phase;
  }
  result.procedure = {now.phase,  now.triangleCleared,       now.lowerThirdFreed, now.twoStructures,
                      now.frozen, lowerThirdAttached(state), now.errors,          now.criticalErrors};
}

}  // namespace calot
