// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/procedure_stage.h"

#include <algorithm>

namespace calot {

namespace {

// Critical view of safety: one point and two points of each criterion (docs/procedure.md; assumed). Larger shares make
// the view easier to reach.
constexpr double clearedOne = 0.35;  ///< share of the fat in the triangle that may be left
constexpr double clearedTwo = 0.10;
constexpr double freedOne = 0.5;  ///< share of the bed's lower third that may still be attached
constexpr double freedTwo = 0.05;
constexpr double bareShare = 0.2;  ///< share of the fat close around a vessel that may be left where it counts as bare

bool opensVessel(EventKind kind) {
  return kind == EventKind::vesselCut || kind == EventKind::vesselBurned || kind == EventKind::vesselTorn;
}

bool isOneOf(const std::vector<std::size_t>& structures, std::size_t subject) {
  return std::find(structures.begin(), structures.end(), subject) != structures.end();
}

}  // namespace

ProcedureStage::ProcedureStage(const Model& model, const Bodies& bodies) : model_(model) {
  const ProcedureModel& procedure = model.procedure();
  for (const ProcedureModel::Divide& vessel : procedure.divide) divided_.push_back(vessel.structure);
  if (!procedure.present || procedure.fat == ProcedureModel::none) return;
  const FatBody& fat = bodies.fat(procedure.fat).fat();
  for (std::size_t r = 0; r < fat.model().regions(); ++r) wholeRegion_.push_back(fat.volume().inRegion(r));
}

/// Share that is left of the fat in a region.
double ProcedureStage::fatLeftIn(const Bodies& bodies, std::size_t region) const {
  const std::size_t fat = model_.procedure().fat;
  if (fat == ProcedureModel::none || region == ProcedureModel::none || !(wholeRegion_[region] > 0.0)) return 0.0;
  return bodies.fat(fat).fat().volume().inRegion(region) / wholeRegion_[region];
}

/// Share of the bed's lower third that is attached.
double ProcedureStage::lowerThirdAttached(const State& state) const {
  const ProcedureModel& procedure = model_.procedure();
  if (procedure.bed == ProcedureModel::none) return 0.0;
  const std::vector<Strand>& bed = model_.connective()[procedure.bed].tissue.strands();
  double all = 0.0;
  double attached = 0.0;
  for (const std::uint32_t s : procedure.lowerThird) {
    all += bed[s].area;
    if (state.connective[procedure.bed].condition[s] == StrandCondition::attached) attached += bed[s].area;
  }
  return all > 0.0 ? attached / all : 0.0;
}

bool ProcedureStage::isParted(const State& state, std::size_t structure) const {
  const StructureModel& s = model_.structures()[structure];
  const BeamModel::Branch& branch = model_.vesselTrees()[s.index].beams.branches()[s.branch];
  const auto first = state.vessel[s.index].parting.begin() + static_cast<std::ptrdiff_t>(branch.firstElement);
  return std::any_of(first, first + static_cast<std::ptrdiff_t>(branch.elements()),
                     [](Parting p) { return p != Parting::none; });
}

void ProcedureStage::judgeView(const Bodies& bodies, const State& state, ProcedureState& procedure) const {
  const ProcedureModel& model = model_.procedure();
  const double left = fatLeftIn(bodies, model.clearRegion);
  procedure.triangleCleared = left <= clearedTwo ? 2 : left <= clearedOne ? 1 : 0;
  const double attached = lowerThirdAttached(state);
  procedure.lowerThirdFreed = attached <= freedTwo ? 2 : attached <= freedOne ? 1 : 0;
  std::size_t seen = 0;
  for (const ProcedureModel::Divide& vessel : model.divide) {
    if (fatLeftIn(bodies, vessel.coverRegion) <= bareShare && !isParted(state, vessel.structure)) ++seen;
  }
  procedure.twoStructures = seen == model.divide.size() ? 2 : seen > 0 ? 1 : 0;
}

/// An event's phase and errors.
void ProcedureStage::countEvent(const Event& event, ProcedureState& procedure, Phase& phase, StepLog& log) const {
  switch (event.kind) {
    case EventKind::clipSet:
      procedure.frozen = true;
      phase = Phase::clipping;
      break;
    case EventKind::clipDropped:
      phase = Phase::clipping;
      ++procedure.errors;
      break;
    case EventKind::clipHalfOn:
    case EventKind::clipOnClip:
    case EventKind::clipTooNear:
    case EventKind::cutThroughClip:
    case EventKind::organPerforated:
    case EventKind::tooFewClips:
      ++procedure.errors;
      break;
    case EventKind::vesselCut:
      phase = Phase::cutting;
      break;
    case EventKind::vesselBurned:
    case EventKind::vesselTorn:
      if (isOneOf(divided_, event.subject)) ++procedure.errors;
      break;
    case EventKind::strandsBurned:
    case EventKind::strandsTorn:
      // Before the first clip the bed's lower third is freed to see what enters the gallbladder.
      phase = procedure.frozen || divided_.empty() ? Phase::dissection : Phase::identification;
      break;
    default:
      break;
  }
  const bool harms = event.kind == EventKind::clipSet || opensVessel(event.kind);
  if (harms && isOneOf(model_.procedure().spare, event.subject)) {
    ++procedure.criticalErrors;
    log.emit(EventKind::criticalError, event.hand, event.subject, event.position, static_cast<double>(event.kind));
  }
}

void ProcedureStage::run(const Bodies& bodies, State& state, StepResult& result, StepLog& log) const {
  if (state.procedure.empty()) return;
  const ProcedureModel& model = model_.procedure();
  ProcedureState& procedure = state.procedure[0];
  const bool allParted =
      std::all_of(divided_.begin(), divided_.end(), [&](std::size_t s) { return isParted(state, s); });

  if (!procedure.frozen) judgeView(bodies, state, procedure);
  Phase phase = procedure.phase;
  const std::size_t reported = result.events.size();
  for (std::size_t i = 0; i < reported; ++i) countEvent(Event(result.events[i]), procedure, phase, log);
  if (model.fat != ProcedureModel::none && result.fat[model.fat].carved > 0.0) {
    phase = allParted ? Phase::dissection : Phase::identification;
  }
  const bool freed = model.bed == ProcedureModel::none || !(result.connective[model.bed].attached > 0.0);
  if (allParted && freed) phase = Phase::done;
  if (phase != procedure.phase) {
    log.emit(EventKind::phaseBegin, StepLog::noHand, static_cast<std::size_t>(phase), Vec3::Zero(),
             static_cast<double>(procedure.phase));
    procedure.phase = phase;
  }
  result.procedure = {procedure.phase,  procedure.triangleCleared, procedure.lowerThirdFreed, procedure.twoStructures,
                      procedure.frozen, lowerThirdAttached(state), procedure.errors,          procedure.criticalErrors};
}

}  // namespace calot
