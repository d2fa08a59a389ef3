// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/judgement/judge.h"

#include <algorithm>
#include <optional>

#include "sim/math/linear.h"

namespace calot {

namespace {

bool contains(const std::vector<std::size_t>& structures, std::size_t structure) {
  return std::find(structures.begin(), structures.end(), structure) != structures.end();
}

bool opensVessel(EventKind kind) {
  return kind == EventKind::vesselCut || kind == EventKind::vesselBurned || kind == EventKind::vesselTorn;
}

/// The value of an event of this kind that stands beside the one at `at`: of the same hand and structure, in this step.
std::optional<double> beside(const std::vector<Event>& events, std::size_t at, EventKind kind) {
  for (std::size_t i = at + 1; i < events.size(); ++i) {
    const Event& e = events[i];
    if (e.kind == events[at].kind && e.hand == events[at].hand) break;
    if (e.kind == kind && e.hand == events[at].hand && e.subject == events[at].subject) return e.value;
  }
  return std::nullopt;
}

}  // namespace

Judge::Judge(const SceneDescription& scene, const JudgementRules& rules) : rules_(rules), clip_(scene.clip) {
  const ProcedureDescription& procedure = scene.procedure;
  present_ = !procedure.specimen.empty();
  if (!present_) return;
  fat_ = indexNamed(scene.fat, procedure.fat);
  hasFat_ = fat_ < scene.fat.size();
  bed_ = indexNamed(scene.connective, procedure.bed);
  hasBed_ = bed_ < scene.connective.size();
  const std::size_t firstVessel = scene.organs.size();
  for (const DivideDescription& d : procedure.divide) {
    const std::size_t vessel = indexNamed(scene.vessels, d.vessel);
    if (vessel == scene.vessels.size()) continue;
    Divide& divide = divide_.emplace_back();
    divide.vessel = vessel;
    divide.structure = firstVessel + vessel;
    divide.clips = {d.patient, d.specimen};
    if (!d.patientAtStart) std::swap(divide.clips[0], divide.clips[1]);
  }
  for (const std::string& name : procedure.spare) {
    const std::size_t vessel = indexNamed(scene.vessels, name);
    if (vessel < scene.vessels.size()) spare_.push_back(firstVessel + vessel);
  }
  now_.phase = hasFat_ ? Phase::identification : !divide_.empty() ? Phase::clipping : Phase::dissection;
}

bool Judge::isReported(const StepResult& result) const {
  return (!hasFat_ || fat_ < result.fat.size()) && (!hasBed_ || bed_ < result.connective.size()) &&
         std::all_of(divide_.begin(), divide_.end(), [&](const Divide& d) { return d.vessel < result.vessel.size(); });
}

bool Judge::isToDivide(std::size_t structure) const {
  return std::any_of(divide_.begin(), divide_.end(), [&](const Divide& d) { return d.structure == structure; });
}

bool Judge::isParted(const StepResult& result, std::size_t vessel) const { return result.vessel[vessel].partings > 0; }

void Judge::judgeView(const StepResult& result) {
  const double left = hasFat_ ? result.fat[fat_].uncleared : 0.0;
  now_.triangleCleared = left <= rules_.clearedTwo ? 2 : left <= rules_.clearedOne ? 1 : 0;
  const double attached = now_.lowerThirdAttached;
  now_.lowerThirdFreed = attached <= rules_.freedTwo ? 2 : attached <= rules_.freedOne ? 1 : 0;
  const auto seen = std::count_if(divide_.begin(), divide_.end(), [&](const Divide& d) {
    return result.vessel[d.vessel].covered <= rules_.bareShare && !isParted(result, d.vessel);
  });
  now_.twoStructures = static_cast<std::size_t>(seen) == divide_.size() ? 2 : seen > 0 ? 1 : 0;
}

void Judge::countError(Event event, EventKind kind, double value) {
  event.kind = kind;
  event.value = value;
  now_.events.push_back(event);
  if (present_) ++now_.errors;
}

void Judge::judgeClip(const std::vector<Event>& events, std::size_t at) {
  if (!beside(events, at, EventKind::clipPlace)) return;  // before version 4: judged at its time
  const Event& clip = events[at];
  if (clip.value < rules_.encloses) countError(clip, EventKind::clipHalfOn, clip.value);
  constexpr double far = 1e300;
  const double gap = beside(events, at, EventKind::clipGap).value_or(far);
  const double junction = beside(events, at, EventKind::clipJunctionGap).value_or(far);
  const bool beyondEnd = beside(events, at, EventKind::clipEndGap).value_or(far) < 0.0;
  if (gap < 0.0) countError(clip, EventKind::clipOnClip, -gap);
  const double nearClip = gap >= 0.0 && gap < clip_.minGap ? gap : far;
  const double nearJunction = junction < clip_.minJunctionGap ? junction : far;
  const double nearest = beyondEnd ? 0.0 : std::min(nearClip, nearJunction);
  if (nearest < far) countError(clip, EventKind::clipTooNear, nearest);
}

/// Clips that the procedure wants beside a cut and that are not there.
void Judge::judgeCut(const std::vector<Event>& events, std::size_t at) {
  const auto start = beside(events, at, EventKind::clipsTowardsStart);
  const auto end = beside(events, at, EventKind::clipsTowardsEnd);
  if (!start || !end) return;  // before version 4: judged at its time
  double missing = 0.0;
  for (const Divide& divide : divide_) {
    if (divide.structure != events[at].subject) continue;
    missing += notNegative(static_cast<double>(divide.clips[0]) - *start);
    missing += notNegative(static_cast<double>(divide.clips[1]) - *end);
  }
  if (missing > 0.0) countError(events[at], EventKind::tooFewClips, missing);
}

void Judge::countEvent(const std::vector<Event>& events, std::size_t at, Phase& phase) {
  const Event& event = events[at];
  if (event.kind == EventKind::criticalError || event.kind == EventKind::phaseBegin) return;  // judged at its time
  now_.events.push_back(event);
  switch (event.kind) {
    case EventKind::clipSet:
      now_.criticalViewFrozen = present_;
      phase = Phase::clipping;
      judgeClip(events, at);
      break;
    case EventKind::clipDropped:
      phase = Phase::clipping;
      if (present_) ++now_.errors;
      break;
    case EventKind::clipHalfOn:
    case EventKind::clipOnClip:
    case EventKind::clipTooNear:
    case EventKind::tooFewClips:
    case EventKind::cutThroughClip:
    case EventKind::organPerforated:
      if (present_) ++now_.errors;
      break;
    case EventKind::vesselCut:
      phase = Phase::cutting;
      judgeCut(events, at);
      break;
    case EventKind::vesselBurned:
    case EventKind::vesselTorn:
      if (isToDivide(event.subject)) ++now_.errors;
      break;
    case EventKind::strandsBurned:
    case EventKind::strandsTorn:
      // Before the first clip the bed's lower third is freed to see what enters the gallbladder.
      phase = now_.criticalViewFrozen || divide_.empty() ? Phase::dissection : Phase::identification;
      break;
    default:
      break;
  }
  const bool harms = event.kind == EventKind::clipSet || opensVessel(event.kind);
  if (!harms || !contains(spare_, event.subject)) return;
  ++now_.criticalErrors;
  Event critical = event;
  critical.kind = EventKind::criticalError;
  critical.value = static_cast<double>(event.kind);
  now_.events.push_back(critical);
}

const Judgement& Judge::observe(const StepResult& result) {
  now_.events.clear();
  Phase phase = now_.phase;
  const bool judged = present_ && isReported(result);
  if (judged) {
    now_.lowerThirdAttached = hasBed_ ? result.connective[bed_].lowerAttached : 0.0;
    if (!now_.criticalViewFrozen) judgeView(result);
  }
  for (std::size_t i = 0; i < result.events.size(); ++i) countEvent(result.events, i, phase);
  if (!judged) return now_;
  const bool allParted =
      std::all_of(divide_.begin(), divide_.end(), [&](const Divide& d) { return isParted(result, d.vessel); });
  if (hasFat_ && result.fat[fat_].carved > 0.0) phase = allParted ? Phase::dissection : Phase::identification;
  const bool held =
      std::any_of(result.fat.begin(), result.fat.end(), [](const FatResult& f) { return f.holdsSpecimen; });
  const bool freed = (!hasBed_ || !(result.connective[bed_].attached > 0.0)) && !held;
  if (allParted && freed) phase = Phase::done;
  if (phase == now_.phase) return now_;
  Event begin;
  begin.step = result.step;
  begin.kind = EventKind::phaseBegin;
  begin.subject = static_cast<std::uint16_t>(phase);
  begin.value = static_cast<double>(now_.phase);
  now_.events.push_back(begin);
  now_.phase = phase;
  return now_;
}

}  // namespace calot
