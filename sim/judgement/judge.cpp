// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/judgement/judge.h"

#include <algorithm>
#include <utility>

#include "sim/math/linear.h"

namespace calot {

namespace {

constexpr std::uint8_t noHand = 255;
constexpr std::uint16_t mostSubjects = 128;  ///< more structures, or connective tissues, than any scene has

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

Judge::Judge(const SceneDescription& scene, const JudgementRules& rules)
    : rules_(rules), clip_(scene.clip), errors_(static_cast<std::uint64_t>(1000 / scene.ticksPerStep)) {
  const ProcedureDescription& procedure = scene.procedure;
  const std::size_t firstVessel = scene.organs.size();
  for (const OrganDescription& organ : scene.organs) role_.push_back(organ.role);
  for (const VesselDescription& vessel : scene.vessels) role_.push_back(vessel.role);
  pressed_.resize(role_.size());
  pressedSteps_ = static_cast<std::uint32_t>(1000.0 * rules.pressedFor / scene.ticksPerStep + 0.5);
  present_ = !procedure.specimen.empty();
  if (!present_) return;
  fat_ = indexNamed(scene.fat, procedure.fat);
  hasFat_ = fat_ < scene.fat.size();
  bed_ = indexNamed(scene.connective, procedure.bed);
  hasBed_ = bed_ < scene.connective.size();
  for (const DivideDescription& d : procedure.divide) {
    const std::size_t vessel = indexNamed(scene.vessels, d.vessel);
    if (vessel == scene.vessels.size()) continue;
    Divide& divide = divide_.emplace_back();
    divide.vessel = vessel;
    divide.structure = firstVessel + vessel;
    divide.clips = {d.patient, d.specimen};
    divide.patientAtStart = d.patientAtStart;
    if (!d.patientAtStart) std::swap(divide.clips[0], divide.clips[1]);
  }
  for (const std::string& name : procedure.spare) {
    const std::size_t vessel = indexNamed(scene.vessels, name);
    if (vessel < scene.vessels.size()) spare_.push_back(firstVessel + vessel);
  }
  parted_.resize(divide_.size());
  now_.phase = hasFat_ ? Phase::identification : !divide_.empty() ? Phase::clipping : Phase::dissection;
}

bool Judge::isReported(const StepResult& result) const {
  return (!hasFat_ || fat_ < result.fat.size()) && (!hasBed_ || bed_ < result.connective.size()) &&
         std::all_of(divide_.begin(), divide_.end(), [&](const Divide& d) { return d.vessel < result.vessel.size(); });
}

std::size_t Judge::dividing(std::size_t structure) const {
  const auto at =
      std::find_if(divide_.begin(), divide_.end(), [&](const Divide& d) { return d.structure == structure; });
  return static_cast<std::size_t>(at - divide_.begin());
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

void Judge::judged(Event event, EventKind kind, double value) {
  event.kind = kind;
  event.value = value;
  now_.events.push_back(event);
  constexpr std::array<std::pair<EventKind, ErrorRule>, 4> rules{{{EventKind::clipHalfOn, ErrorRule::clipHalfOn},
                                                                  {EventKind::clipOnClip, ErrorRule::clipOnClip},
                                                                  {EventKind::clipTooNear, ErrorRule::clipTooNear},
                                                                  {EventKind::pressedHard, ErrorRule::pressedHard}}};
  for (const auto& [of, rule] : rules) {
    if (of == kind) find(rule, event);
  }
}

void Judge::judgeClip(const std::vector<Event>& events, std::size_t at) {
  const auto place = beside(events, at, EventKind::clipPlace);
  if (!place) return;  // before version 4: judged at its time
  const Event& clip = events[at];
  if (clip.value < rules_.encloses) {
    judged(clip, EventKind::clipHalfOn, clip.value);
  } else {
    closeEnds(dividing(clip.subject), *place, true);
  }
  constexpr double far = 1e300;
  const double gap = beside(events, at, EventKind::clipGap).value_or(far);
  const double junction = beside(events, at, EventKind::clipJunctionGap).value_or(far);
  const bool beyondEnd = beside(events, at, EventKind::clipEndGap).value_or(far) < 0.0;
  if (gap < 0.0) judged(clip, EventKind::clipOnClip, -gap);
  const double nearClip = gap >= 0.0 && gap < clip_.minGap ? gap : far;
  const double nearJunction = junction < clip_.minJunctionGap ? junction : far;
  const double nearest = beyondEnd ? 0.0 : std::min(nearClip, nearJunction);
  if (nearest < far) judged(clip, EventKind::clipTooNear, nearest);
}

/// Clips that the procedure wants beside a cut and that are not there.
void Judge::judgeCut(const std::vector<Event>& events, std::size_t at) {
  const auto start = beside(events, at, EventKind::clipsTowardsStart);
  const auto end = beside(events, at, EventKind::clipsTowardsEnd);
  const std::size_t of = dividing(events[at].subject);
  if (!start || !end || of == divide_.size()) return;  // before version 4: judged at its time
  const Divide& divide = divide_[of];
  const std::array<double, 2> missing{notNegative(static_cast<double>(divide.clips[0]) - *start),
                                      notNegative(static_cast<double>(divide.clips[1]) - *end)};
  if (!(missing[0] + missing[1] > 0.0)) return;
  judged(events[at], EventKind::tooFewClips, missing[0] + missing[1]);
  const std::size_t patient = divide.patientAtStart ? 0 : 1;
  if (missing[patient] > 0.0) find(ErrorRule::tooFewClips, now_.events.back());
  if (missing[1 - patient] > 0.0) find(ErrorRule::tooFewTowardsSpecimen, now_.events.back());
}

/// A vessel that is to be divided was cut, burned through or torn.
void Judge::judgeParting(const std::vector<Event>& events, std::size_t at) {
  const Event& event = events[at];
  const std::size_t of = dividing(event.subject);
  if (of == divide_.size()) return;
  const bool tears = event.kind == EventKind::vesselTorn;
  if (!tears) closeEnds(of, event.value, false);
  const bool isSealed = beside(events, at, EventKind::vesselSealed).has_value();
  if (event.kind == EventKind::vesselBurned)
    find(isSealed ? ErrorRule::burnedAndSealed : ErrorRule::burnedThrough, event);
  if (tears) find(ErrorRule::torn, event);
  if (event.kind == EventKind::vesselCut) judgeCut(events, at);
  const bool hides = hasFat_ || hasBed_;
  if (!tears && hides && !parted_[of] && now_.criticalView() < rules_.satisfactory)
    find(now_.criticalView() < rules_.identified ? ErrorRule::notIdentified : ErrorRule::viewIncomplete, event);
  parted_[of] = true;
  if (tears) return;  // its open ends come as events of their own
  for (std::size_t i = at + 1; i < events.size() && events[i].kind != event.kind; ++i) {
    if (events[i].kind == EventKind::cutOpen && events[i].subject == event.subject && events[i].hand == event.hand)
      judgeOpenEnds(events[i], event.value);
  }
}

/// @param open its value: 1 the end towards the vessel's start, 2 the other, 3 both @param arc of the parting; none:
/// torn
void Judge::judgeOpenEnds(const Event& open, std::optional<double> arc) {
  const std::size_t of = dividing(open.subject);
  if (of == divide_.size()) return;
  for (const bool atStart : {true, false}) {
    if (open.value != (atStart ? 1.0 : 2.0) && open.value != 3.0) continue;
    const bool stays = atStart == divide_[of].patientAtStart;
    if (!stays && !carriesBile(role_[open.subject])) continue;
    const ErrorRule rule = stays ? ErrorRule::leftOpen : ErrorRule::openTowardsSpecimen;
    open_.push_back({of, atStart, arc, rule});
    find(rule, open);
  }
}

/// Open ends that lie beyond a place, seen from the piece that they belong to, are open no more: a clip closes them, or
/// a new parting makes them ends of another piece. @param torn those of a tear, too, whose place is not known
void Judge::closeEnds(std::size_t of, double place, bool torn) {
  for (std::size_t i = 0; i < open_.size();) {
    const OpenEnd end = open_[i];
    const bool closes = end.vessel == of && (end.arc ? (end.atStart ? place < *end.arc : place > *end.arc) : torn);
    if (!closes) {
      ++i;
      continue;
    }
    open_.erase(open_.begin() + static_cast<std::ptrdiff_t>(i));
    const bool remains = std::any_of(open_.begin(), open_.end(),
                                     [&](const OpenEnd& e) { return e.vessel == end.vessel && e.rule == end.rule; });
    if (remains) continue;
    errors_.takeBack(end.rule, static_cast<std::uint16_t>(divide_[of].structure));
    now_.changed = true;
  }
}

/// Harm to a structure that must be spared.
void Judge::judgeHarm(const Event& event) {
  const auto rule = [&]() -> std::optional<ErrorRule> {
    switch (event.kind) {
      case EventKind::clipSet:
        return ErrorRule::sparedClipped;
      case EventKind::vesselCut:
        return ErrorRule::sparedCut;
      case EventKind::vesselBurned:
        return ErrorRule::sparedBurned;
      case EventKind::vesselTorn:
        return ErrorRule::sparedTorn;
      case EventKind::wallInjured:
        return ErrorRule::sparedHeated;
      default:
        return std::nullopt;
    }
  }();
  if (rule) find(*rule, event);
}

/// A liver on which an instrument, tip or shaft, presses too hard.
void Judge::judgePressing(const StepResult& result) {
  for (std::size_t s = 0; s < role_.size(); ++s) {
    if (role_[s] != StructureRole::liver) continue;
    for (std::size_t h = 0; h < handCount; ++h) {
      const HandResult& hand = result.hand[h];
      const double force = s < hand.structureForce.size() ? hand.structureForce[s] : 0.0;
      std::uint32_t& steps = pressed_[s][h];
      steps = force > rules_.pressedForce ? steps + 1 : 0;
      if (steps < pressedSteps_) continue;
      Event event;
      event.step = result.step;
      event.kind = EventKind::pressedHard;
      event.hand = static_cast<std::uint8_t>(h);
      event.subject = static_cast<std::uint16_t>(s);
      event.position = hand.tipSimulated;
      event.value = force;
      if (steps == pressedSteps_) {
        judged(event, EventKind::pressedHard, force);
      } else {
        errors_.goOn({ErrorRule::pressedHard, event});
        now_.changed = true;
      }
    }
  }
}

void Judge::judgeEvent(const std::vector<Event>& events, std::size_t at) {
  const Event& event = events[at];
  const bool isSpared = std::find(spare_.begin(), spare_.end(), event.subject) != spare_.end();
  if (isSpared) judgeHarm(event);
  switch (event.kind) {
    case EventKind::clipSet:
      judgeClip(events, at);
      break;
    case EventKind::clipHalfOn:
      find(ErrorRule::clipHalfOn, event);
      break;
    case EventKind::clipOnClip:
      find(ErrorRule::clipOnClip, event);
      break;
    case EventKind::clipTooNear:
      find(ErrorRule::clipTooNear, event);
      break;
    case EventKind::clipDropped:
      find(ErrorRule::clipLost, event);
      break;
    case EventKind::tooFewClips:
      find(ErrorRule::tooFewClips, event);
      break;
    case EventKind::cutThroughClip:
      find(ErrorRule::cutThroughClip, event);
      break;
    case EventKind::vesselCut:
    case EventKind::vesselBurned:
    case EventKind::vesselTorn:
      judgeParting(events, at);
      break;
    case EventKind::cutOpen:
      if (event.hand == noHand) judgeOpenEnds(event, {});  // of a vessel that tears
      break;
    case EventKind::wallInjured:
      if (!isSpared) find(ErrorRule::heated, event);
      break;
    case EventKind::organPerforated:
      find(ErrorRule::perforated, event);
      break;
    case EventKind::tissueTear:
      find(event.subject < role_.size() && role_[event.subject] == StructureRole::liver ? ErrorRule::organTorn
                                                                                        : ErrorRule::tornFromJaws,
           event);
      break;
    case EventKind::graspSlip:
      find(ErrorRule::slipped, event);
      break;
    case EventKind::strandsTorn:
      find(ErrorRule::strandsTorn, event);
      break;
    default:
      break;
  }
}

/// The phase that an act makes.
void Judge::follow(const Event& event, Phase& phase) {
  switch (event.kind) {
    case EventKind::clipSet:
      now_.criticalViewFrozen = present_;
      phase = Phase::clipping;
      break;
    case EventKind::clipDropped:
      phase = Phase::clipping;
      break;
    case EventKind::vesselCut:
      phase = Phase::cutting;
      break;
    case EventKind::strandsBurned:
    case EventKind::strandsTorn:
      // Before the first clip the bed's lower third is freed to see what enters the gallbladder.
      phase = now_.criticalViewFrozen || divide_.empty() ? Phase::dissection : Phase::identification;
      break;
    default:
      break;
  }
}

void Judge::countErrors() {
  // A damaged recording may name any subject: its errors are of none that the scene has, and their list has an end.
  std::erase_if(now_.found, [](const JudgedError& error) { return error.event.subject >= mostSubjects; });
  if (now_.found.empty() && !now_.changed) return;
  for (const JudgedError& error : now_.found) {
    if (textOf(error.rule).severity != Severity::critical) continue;
    Event critical = error.event;
    critical.kind = EventKind::criticalError;
    critical.value = static_cast<double>(error.event.kind);
    now_.events.push_back(critical);
  }
  errors_.add(now_.found);
  now_.errorList = errors_.all();
  for (std::size_t s = 0; s < severityCount; ++s) now_.errorCount[s] = errors_.count(static_cast<Severity>(s + 1));
  now_.changed = true;
}

const Judgement& Judge::observe(const StepResult& result) {
  now_.events.clear();
  now_.found.clear();
  now_.changed = false;
  Phase phase = now_.phase;
  const bool judged = present_ && isReported(result);
  if (judged) {
    now_.lowerThirdAttached = hasBed_ ? result.connective[bed_].lowerAttached : 0.0;
    if (!now_.criticalViewFrozen) judgeView(result);
  }
  for (std::size_t i = 0; i < result.events.size(); ++i) {
    const Event& event = result.events[i];
    if (event.kind == EventKind::criticalError || event.kind == EventKind::phaseBegin) continue;  // of its time
    now_.events.push_back(event);
    follow(event, phase);
    judgeEvent(result.events, i);
  }
  judgePressing(result);
  countErrors();
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
