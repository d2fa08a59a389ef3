// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/judgement/error_rules.h"
#include "sim/scene/description.h"
#include "sim/scene/step_result.h"

namespace calot {

// Judgement of an attempt at a step, as opposed to the step's raw facts: phase, critical view of safety, errors
// (docs/explanation/procedure.md). Judged from StepResult alone, so that recordings of any simulation version can be
// judged again.

/// Rises when a rule or a threshold below changes: figures that stand on it then have a new version.
inline constexpr std::uint32_t judgementVersion = 2;

/// Phase of an attempt. Numbers are stored in recordings before version 4 of StepResult, and in events.
enum class Phase : std::uint8_t { none = 0, identification = 1, clipping = 2, cutting = 3, dissection = 4, done = 5 };

/// Every threshold of grading. None is measured: each is this program's reading of its source.
struct JudgementRules {
  /// Critical view of safety, shares for one point and for two of each criterion. Larger shares make the view easier.
  double clearedOne = 0.35;  ///< fat in the triangle that may be left
  double clearedTwo = 0.10;
  double freedOne = 0.5;  ///< of the bed's lower third that may still be attached
  double freedTwo = 0.05;
  double bareShare = 0.2;      ///< fat close around a vessel that may be left where it counts as bare
  double pressedForce = 3.38;  ///< of an instrument on the liver, above which it is pressed hard (N)
  double pressedFor = 0.1;     ///< as long as that lasts at least (s)
  double encloses = 0.999;     ///< share of a vessel between a clip's legs, below which the clip is half on
  /// Points out of six: the view is satisfactory from here on (the published doublet view).
  int satisfactory = 5;
  /// Points below which a vessel that is divided was not identified.
  int identified = 3;
};

/// Progress of the procedure.
struct ProcedureStatus {
  Phase phase = Phase::none;         ///< phases may recur
  std::uint8_t triangleCleared = 0;  ///< critical view of safety, 0 to 2 each, frozen at the first clip:
  std::uint8_t lowerThirdFreed = 0;
  std::uint8_t twoStructures = 0;
  bool criticalViewFrozen = false;
  double lowerThirdAttached = 0.0;                        ///< share of the lower third of the bed
  std::array<std::uint32_t, severityCount> errorCount{};  ///< occasions so far, minor ones first

  [[nodiscard]] std::uint32_t errors(Severity severity) const {
    return errorCount[static_cast<std::size_t>(severity) - 1];
  }
  [[nodiscard]] std::uint32_t errors() const { return errorCount[0] + errorCount[1] + errorCount[2]; }
  [[nodiscard]] int criticalView() const { return triangleCleared + lowerThirdFreed + twoStructures; }
};

/// The judgement after a step.
struct Judgement : ProcedureStatus {
  /// The step's events with what is judged of them beside them, as people read them.
  std::vector<Event> events;
  std::vector<JudgedError> found;       ///< errors of the step
  std::vector<AttemptError> errorList;  ///< of the attempt so far, as ErrorList::all()
  bool changed = false;                 ///< `errorList` did, in the step
};

/// Judges an attempt step by step. Live panel, hints, performers, replay, assessment and regrading all use this; it
/// obeys the determinism contract, sees StepResult alone, and nothing of it is State.
///
/// Recordings before version 4 of StepResult hold what was judged of clips and cuts at their time as events of their
/// own; where the facts behind them are missing, those count as they were recorded.
class Judge {
 public:
  /// @param scene the attempt's own: what its procedure wants
  explicit Judge(const SceneDescription& scene, const JudgementRules& rules = {});

  /// Judges the next step. @pre results come in the order of steps, from the attempt's first one on
  const Judgement& observe(const StepResult& result);

  /// After the last observed step; before the first, the phase in which the procedure begins.
  [[nodiscard]] const Judgement& judgement() const { return now_; }
  [[nodiscard]] const JudgementRules& rules() const { return rules_; }

 private:
  /// A vessel that is to be divided.
  struct Divide {
    std::size_t vessel = 0;              ///< of the scene's
    std::size_t structure = 0;           ///< of the scene's
    std::array<std::size_t, 2> clips{};  ///< wanted towards its start and towards its end
    bool patientAtStart = true;          ///< the piece at its start stays
  };

  /// True if there are results of everything that the procedure names; false before version 3 of StepResult.
  [[nodiscard]] bool isReported(const StepResult& result) const;
  /// Index in divide_; its size: not to be divided.
  [[nodiscard]] std::size_t dividing(std::size_t structure) const;
  [[nodiscard]] bool isParted(const StepResult& result, std::size_t vessel) const;
  /// An end of a parted vessel that nothing closes.
  struct OpenEnd {
    std::size_t vessel = 0;     ///< index in divide_
    bool atStart = false;       ///< the piece towards the vessel's start
    std::optional<double> arc;  ///< of the end from the vessel's start (m); none of a torn one
    ErrorRule rule;             ///< by which it counts
  };

  void judgeView(const StepResult& result);
  void judgeClip(const std::vector<Event>& events, std::size_t at);
  void judgeCut(const std::vector<Event>& events, std::size_t at);
  void judgeParting(const std::vector<Event>& events, std::size_t at);
  void judgeOpenEnds(const Event& open, std::optional<double> arc);
  void closeEnds(std::size_t of, double place, bool torn);
  void judgeHarm(const Event& event);
  void judgePressing(const StepResult& result);
  void judgeEvent(const std::vector<Event>& events, std::size_t at);
  void follow(const Event& event, Phase& phase);
  void find(ErrorRule rule, const Event& event) { now_.found.push_back({rule, event}); }
  void countErrors();
  void judged(Event event, EventKind kind, double value);

  JudgementRules rules_;
  ClipDescription clip_;
  bool present_ = false;  ///< the scene has a procedure
  bool hasFat_ = false;
  bool hasBed_ = false;
  std::size_t fat_ = 0;  ///< the procedure's body of fat
  std::size_t bed_ = 0;  ///< the procedure's connective tissue
  std::vector<Divide> divide_;
  std::vector<std::size_t> spare_;                             ///< structures
  std::vector<StructureRole> role_;                            ///< of the structures
  std::vector<bool> parted_;                                   ///< of divide_: it was cut, burned or torn before
  std::uint32_t pressedSteps_ = 0;                             ///< of rules_.pressedFor
  std::vector<std::array<std::uint32_t, handCount>> pressed_;  ///< of the structures: steps so far
  std::vector<OpenEnd> open_;
  ErrorList errors_;
  Judgement now_;
};

}  // namespace calot
