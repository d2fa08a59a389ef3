// SPDX-License-Identifier: GPL-3.0-or-later
// Errors and safety: clips, cautery in the air, injuries, the critical view, and requests to the assistant.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "analytics/checkpoints/error_words.h"
#include "analytics/checkpoints/figures/rows.h"
#include "analytics/checkpoints/phases.h"
#include "sim/instruments/instruments.h"

namespace calot::analytics {
namespace {

constexpr Requirement hasRequests{[](const AttemptContext& context) { return context.scene.retractionOnRequest; },
                                  "the scene has no retraction that can be asked for"};

/// Clips that were lost or sit badly, by the geometric rules of the step (docs/explanation/vessels.md).
struct ClipErrors {
  const AttemptContext& context;
  std::uint64_t set = 0, dropped = 0, faulty = 0;
  std::uint64_t halfOn = 0, onClip = 0, tooNear = 0, elsewhere = 0;

  void add(const recorder::StepRecord& /*record*/, const Judgement& judgement) {
    const std::vector<Event>& events = judgement.events;
    for (const Event& event : events) {
      if (event.kind == EventKind::clipDropped) ++dropped;
      if (event.kind != EventKind::clipSet) continue;
      ++set;
      // A clip's faults are reported beside it, in the same step, of the same hand.
      const auto beside = [&](EventKind kind) {
        return std::any_of(events.begin(), events.end(),
                           [&](const Event& e) { return e.kind == kind && e.hand == event.hand; });
      };
      const bool isHalfOn = beside(EventKind::clipHalfOn), isOnClip = beside(EventKind::clipOnClip);
      const bool isTooNear = beside(EventKind::clipTooNear), isElsewhere = !isCystic(event.subject);
      halfOn += isHalfOn ? 1 : 0;
      onClip += isOnClip ? 1 : 0;
      tooNear += isTooNear ? 1 : 0;
      elsewhere += isElsewhere ? 1 : 0;
      faulty += isHalfOn || isOnClip || isTooNear || isElsewhere ? 1 : 0;
    }
  }
  [[nodiscard]] Measured figure() const {
    if (set + dropped == 0) return Measured::notApplicable("no clip was set or dropped");
    return Measured::of(static_cast<double>(faulty + dropped),
                        fmt::format("{} set; half on {}, on another clip {}, too near {}, on another vessel {}, "
                                    "dropped {}",
                                    set, halfOn, onClip, tooNear, elsewhere, dropped));
  }

 private:
  [[nodiscard]] bool isCystic(std::size_t structure) const {
    const std::size_t organs = context.scene.organ.size();
    return structure >= organs && structure - organs < context.scene.vessel.size() &&
           context.scene.vessel[structure - organs].cystic;
  }
};

/// One hook's current in the air, debounced: a hook that hops over tissue is not held in the air.
class CurrentInTheAir {
 public:
  explicit CurrentInTheAir(const AttemptContext& context) : context_(context) {}

  void add(const HandResult& result) {
    hook_ = hook_ || instrumentOf(result.instrument).action == InstrumentAction::burn;
    if (result.cautery == Cautery::withoutContact) {
      ++stretch_;
    } else {
      endStretch();
    }
  }
  void endStretch() {
    counted_ += counts(stretch_);
    stretch_ = 0;
  }
  /// Sum over all stretches that are long enough, including the present one.
  [[nodiscard]] Measured figure(const AttemptEnd& end) const {
    if (!hook_) return Measured::notApplicable("no hook in this hand");
    return Measured::of(context_.seconds(counted_ + counts(stretch_)), stretchNote(end));
  }

 private:
  /// Shorter stretches do not count (s).
  static constexpr double minStretch = 0.1;
  /// As many steps, if they are enough. Half a tick of tolerance: lengths are products of rounded numbers.
  [[nodiscard]] std::uint64_t counts(std::uint64_t steps) const {
    return context_.seconds(steps) + 0.5 * context_.tickSeconds >= minStretch ? steps : 0;
  }

  const AttemptContext& context_;
  bool hook_ = false;          ///< one was mounted at any time
  std::uint64_t counted_ = 0;  ///< steps of the stretches that are over
  std::uint64_t stretch_ = 0;  ///< steps of the present one
};

struct CauteryWithoutContact {
  const AttemptContext& context;
  std::vector<CurrentInTheAir> hand = std::vector<CurrentInTheAir>(handCount, CurrentInTheAir(context));

  void add(const StepResult& result) {
    for (std::size_t h = 0; h < hand.size(); ++h) hand[h].add(result.hand[h]);
  }
  /// A stretch that continues into the next phase counts with each of its parts that is long enough.
  void leavePhase() {
    for (CurrentInTheAir& one : hand) one.endStretch();
  }
  [[nodiscard]] Measured figure(const AttemptEnd& end, std::size_t h) const { return hand[h].figure(end); }
};

/// Organs opened by cautery or by tearing: a perforated gallbladder spills bile.
struct OrganPerforations {
  const AttemptContext& context;
  std::vector<std::uint64_t> count = std::vector<std::uint64_t>(context.scene.organ.size());

  void add(const StepResult& result) {
    for (const Event& event : result.events) {
      if (event.kind == EventKind::organPerforated && event.subject < count.size()) ++count[event.subject];
    }
  }
  [[nodiscard]] Measured figure(std::size_t o) const {
    const std::string why = context.scene.organ[o].hasWall ? whyTooOld(context, 3)
                                                           : "the scene gives this organ no wall that could be opened";
    return why.empty() ? Measured::of(static_cast<double>(count[o])) : Measured::notApplicable(why);
  }
};

/// Heat on the walls of vessels that must be spared: it injures long before it opens them.
struct ThermalInjury {
  const AttemptContext& context;
  std::vector<double> injured = std::vector<double>(context.scene.vessel.size());  ///< m

  void add(const StepResult& result) {
    for (std::size_t v = 0; v < injured.size(); ++v) injured[v] = result.vessel[v].injured;
  }
  [[nodiscard]] Measured figure() const {
    double sum = 0.0;
    std::string note;
    for (std::size_t v = 0; v < injured.size(); ++v) {
      const SceneFacts::Vessel& vessel = context.scene.vessel[v];
      if (vessel.spared) sum += injured[v];
      if (injured[v] > 0.0)
        note += fmt::format("{}{} {:.2f} mm", note.empty() ? "" : ", ", vessel.name, 1000.0 * injured[v]);
    }
    return Measured::of(sum, std::move(note));
  }
};

/// The critical view of safety at the first clip.
struct CriticalView {
  ProcedureStatus view = {};

  void add(const recorder::StepRecord& /*record*/, const Judgement& judgement) { view = judgement; }
  [[nodiscard]] Measured figure(const AttemptEnd& end) const {
    const int points = view.criticalView();
    if (!view.criticalViewFrozen && end.outcome != recorder::Outcome::running)
      return Measured::notAvailable(fmt::format("no clip was set: {} of 6 points at the end", points));
    return Measured::of(static_cast<double>(points),
                        fmt::format("triangle {}, lower third {}, two structures {}", view.triangleCleared,
                                    view.lowerThirdFreed, view.twoStructures));
  }
};

/// Errors of one severity, by the rules of sim/judgement/error_rules.h.
struct ErrorsOf {
  const AttemptContext& context;
  Severity severity;
  std::vector<AttemptError> errors = {};

  void add(const recorder::StepRecord& /*record*/, const Judgement& judgement) {
    if (judgement.changed) errors = judgement.errorList;
  }
  [[nodiscard]] Measured figure() const {
    const bool critical = severity == Severity::critical;
    SeverityWords words = wordsOf(linesOf(errors, context.subjects, context.stepSeconds()), severity,
                                  critical ? context.notAssessed : std::vector<std::string>());
    return Measured::of(static_cast<double>(words.count), std::move(words.lines));
  }
};

CheckpointEntry errorsRow(Severity severity, const char* name, const char* title, int rank, const char* definition) {
  return {.place = {CheckpointFamily::safety, rank, severity == Severity::critical ? "critical" : ""},
          .definition = {.name = name,
                         .title = title,
                         .direction = Direction::lower,
                         .instruments = "sum over instruments",
                         .domain = Domain::whole,
                         .version = errorVersion(1),
                         .definition = definition},
          .results = 3,
          .accumulate = accumulating<ErrorsOf>(severity)};
}

/// How often the assistant was asked to retract more or less, and how often that was taken back.
struct Retraction {
  const AttemptContext& context;
  bool reversals;
  std::optional<EventKind> last = {};
  std::uint64_t count = 0;

  void add(const StepResult& result) {
    for (const Event& event : result.events) {
      if (event.kind != EventKind::retractionMore && event.kind != EventKind::retractionLess) continue;
      count += !reversals || (last && *last != event.kind) ? 1 : 0;
      last = event.kind;
    }
  }
  [[nodiscard]] Measured figure() const { return Measured::of(static_cast<double>(count)); }
};

}  // namespace

std::vector<CheckpointEntry> safetyRows() {
  const CheckpointEntry cautery{
      .place = {CheckpointFamily::safety, 20},
      .definition = {.name = "cautery-without-contact",
                     .title = "Cautery without contact",
                     .unit = "s",
                     .direction = Direction::lower,
                     .window = "whole attempt, while a hook is mounted",
                     .aggregation = Aggregation::hand,
                     .instruments = "each hand by itself",
                     .filter = "stretches of at least 0.1 s; any touch of tissue, or current off, ends a stretch",
                     .definition = "sum of the lengths of the stretches of steps in which the hook carries current "
                                   "and touches nothing, without those under 0.1 s"},
      .results = 3,
      .accumulate = accumulating<CauteryWithoutContact>()};
  CheckpointEntry critical = errorsRow(Severity::critical, "critical-errors", "Critical errors", 90,
                                       "#{occasions of critical errors}; the rules are in the procedure's table of "
                                       "errors; one fails the attempt");
  critical.needs = {hasProcedure};
  return {
      cautery,
      phaseRow(cautery, 150, "steps", accumulating<PerPhase<CauteryWithoutContact>>()),
      {.place = {CheckpointFamily::motion, 210},
       .definition = {.name = "retraction-requests",
                      .title = "Times that the assistant was asked to retract more or less",
                      .instruments = "both together",
                      .domain = Domain::whole,
                      .definition = "#{requests for more retraction} + #{requests for less}, those at a limit of the "
                                    "pull too"},
       .needs = {hasRequests},
       .accumulate = accumulating<Retraction>(false)},
      {.place = {CheckpointFamily::motion, 220},
       .definition = {.name = "retraction-reversals",
                      .title = "Times that a request to the assistant was taken back",
                      .direction = Direction::lower,
                      .instruments = "both together",
                      .domain = Domain::whole,
                      .definition = "#{requests for less whose last one before was for more, and the reverse}"},
       .needs = {hasRequests},
       .accumulate = accumulating<Retraction>(true)},
      {.place = {CheckpointFamily::safety, 10},
       .definition = {.name = "clip-errors",
                      .title = "Clips misplaced or lost",
                      .direction = Direction::lower,
                      .instruments = "sum over instruments",
                      .domain = Domain::whole,
                      .version = judgedVersion(1),
                      .definition = "E = #{clips set half on, on another clip, too near to something, or on a vessel "
                                    "that is not cystic} + #{clips dropped}; a clip with several faults counts once"},
       .needs = {hasVessels},
       .results = 3,
       .accumulate = accumulating<ClipErrors>()},
      {.place = {CheckpointFamily::safety, 40},
       .definition = {.name = "organ-perforations",
                      .title = "Perforations of the organ",
                      .direction = Direction::lower,
                      .aggregation = Aggregation::organ,
                      .instruments = "sum over instruments",
                      .domain = Domain::whole,
                      .version = 2,
                      .definition = "P(o) = #{events organPerforated of organ o}; at most one an organ"},
       .accumulate = accumulating<OrganPerforations>(),
       .subjects = organNames},
      {.place = {CheckpointFamily::safety, 45},
       .definition = {.name = "thermal-injury",
                      .title = "Spared vessels' walls injured by heat",
                      .displayUnit = "mm",
                      .direction = Direction::lower,
                      .definition = "sum over the vessels that the scene's procedure tells to spare of the length of "
                                    "wall whose cautery reached the scene's share `injury` of what parts it"},
       .needs = {hasProcedure, hasSpared},
       .results = 5,
       .accumulate = accumulating<ThermalInjury>()},
      {.place = {CheckpointFamily::safety, 80},
       .definition = {.name = "critical-view",
                      .title = "Critical view of safety",
                      .displayUnit = "points",
                      .direction = Direction::higher,
                      .window = "until the first clip, where the view is frozen",
                      .instruments = "none",
                      .finality = Finality::final,
                      .domain = Domain::whole,
                      .version = judgedVersion(1),
                      .definition = "sum of 0 to 2 points each for the cleared triangle, the freed lower third of the "
                                    "bed, and two structures alone entering the gallbladder; satisfactory from 5 of "
                                    "6"},
       .needs = {hasProcedure, hasCystic},
       .results = 3,
       .accumulate = accumulating<CriticalView>()},
      critical,
      errorsRow(Severity::major, "major-errors", "Major errors", 92,
                "#{occasions of major errors}; the rules are in the procedure's table of errors"),
      errorsRow(Severity::minor, "minor-errors", "Minor errors", 94,
                "#{occasions of minor errors}; the rules are in the procedure's table of errors"),
  };
}

}  // namespace calot::analytics
