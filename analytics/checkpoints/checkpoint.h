// SPDX-License-Identifier: GPL-3.0-or-later
// A checkpoint is one figure of an attempt (or one per hand, or one per organ), computed from the stream of steps.
// docs/reference/metrics.md gives the formula, source and pitfalls of each; a test holds it against the
// registry.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "analytics/checkpoints/definition.h"
#include "analytics/checkpoints/error_words.h"
#include "recorder/base/identity.h"
#include "recorder/engine/observer.h"
#include "recorder/sources/scope/endoscope.h"
#include "sim/judgement/judge.h"
#include "sim/scene/description.h"

namespace calot::analytics {

/// Taken from the scene's roles (StructureRole) and sizes, never from names, looks or numbers of structures: so they
/// hold for any scene.
struct SceneFacts {
  struct Organ {
    std::string name;
    StructureRole role = StructureRole::other;
    double skinArea = 0.0;  ///< of its surface at rest (m^2)
    bool hasWall = false;   ///< it can be perforated
  };
  struct Vessel {
    std::string name;
    bool cystic = false;  ///< cystic duct or cystic artery
    bool spared = false;  ///< the procedure says that it must be spared
  };
  struct Connective {
    std::string name;
    bool holdsGallbladder = false;  ///< it is a cystic plate
    double area = 0.0;              ///< of its bed at rest (m^2), where it holds a gallbladder (connective_tissue.h)
  };
  /// In the scene's order: the columns of StepResult.
  std::vector<Organ> organ;
  std::vector<Vessel> vessel;
  std::vector<Connective> connective;
  std::size_t fat = 0;               ///< bodies
  bool triangle = false;             ///< a region of fat that is to be cleared is marked
  bool retractionOnRequest = false;  ///< the assistant can be asked to retract more or less
  recorder::PictureFrame picture = {};

  [[nodiscard]] bool hasCystic() const;  ///< there is a cystic vessel
  [[nodiscard]] bool hasSpared() const;  ///< there is a vessel to be spared
};

SceneFacts sceneFacts(const SceneDescription& scene);

/// Availability of a number, and the kind of missing value. Numbers are stored and never reused.
enum class Availability : std::uint8_t {
  value = 0,              ///< there is a number
  notApplicable = 1,      ///< the question has no answer for this attempt ("no movement of 5 mm/s for 0.2 s")
  notAvailable = 2,       ///< it has one, but what is recorded doesn't give it ("time limit reached")
  absentHand = 3,         ///< the hand has no instrument
  tooLittleCoverage = 4,  ///< samples cover too little of the window, or leave a gap that is not bridged
};
inline constexpr std::size_t availabilityCount = 5;
std::string nameOf(Availability availability);  ///< "value", "not applicable", ..., "too little coverage"

/// One figure. @invariant availability == value exactly when `value` holds a finite number; else `reason` is not empty.
struct CheckpointValue {
  std::string name;
  std::string subject;        ///< "" (attempt), "left" / "right" (hand), the organ's name, the phase's, "left clipping"
  std::uint32_t version = 1;  ///< of the checkpoint's definition
  Availability availability = Availability::value;
  std::optional<double> value;  ///< in `unit`
  std::string reason;           ///< why there is no value
  std::string note;             ///< what a reader of the value must know ("0.340 s without measurement"), or empty
  std::string unit;             ///< SI
  Origin origin = Origin::resimulated;
  std::string filter;  ///< as declared when the value was made
  /// Share of the window that samples cover, in [0, 1]; none where it isn't of samples, or the hand is absent.
  std::optional<double> coverage;
  std::optional<double> rate = {};   ///< of the tracker's samples (Hz), as Motion::rate; of both hands the lower
  std::optional<double> noise = {};  ///< of the tracker (m), as Motion::noise; of both hands the greater
  ExternalMetricRef metric = {};     ///< of origin `external`, and of no other
  bool operator==(const CheckpointValue&) const = default;
};

/// Facts known before the first step.
struct AttemptContext {
  double tickSeconds = tickLength;
  std::uint32_t ticksPerStep = 10;
  std::vector<std::string> structures;  ///< organs, vessels, fat: as bits of `touching` and subjects of events count
  std::uint32_t resultVersion = 0;      ///< of the StepResults
  bool procedure = false;               ///< the scene has a procedure
  std::string handedness = "unknown";   ///< as recorded: "right", "left", "unknown"
  SceneFacts scene;
  SubjectNames subjects = {};                 ///< of events
  std::vector<std::string> notAssessed = {};  ///< errors that scene and results cannot tell

  /// Duration of a number of steps (s).
  [[nodiscard]] double seconds(std::uint64_t steps) const {
    return static_cast<double>(steps * ticksPerStep) * tickSeconds;
  }
  [[nodiscard]] double stepSeconds() const { return tickSeconds * static_cast<double>(ticksPerStep); }
};

/// A figure, or the reason why it is missing.
struct Measured {
  std::optional<double> value = {};
  Availability missing = Availability::notApplicable;
  std::string reason = {};
  std::string note = {};
  std::optional<double> coverage = {};          ///< MotionCoverage::share()
  std::optional<double> rate = {}, noise = {};  ///< as CheckpointValue's

  static Measured of(double figure, std::string note = {}) {
    return {.value = figure, .missing = Availability::value, .note = std::move(note)};
  }
  static Measured none(Availability missing, std::string why) { return {.missing = missing, .reason = std::move(why)}; }
  static Measured notApplicable(std::string why) { return none(Availability::notApplicable, std::move(why)); }
  static Measured notAvailable(std::string why) { return none(Availability::notAvailable, std::move(why)); }
};

/// Empty when results of `needed` or later are there; else why a checkpoint that reads them is not applicable.
std::string whyTooOld(const AttemptContext& context, std::uint32_t needed);

/// Version of a definition that stands on judgement (phases, critical view, errors): rises with the rules' own.
constexpr std::uint32_t judgedVersion(std::uint32_t own) { return own + judgementVersion - 1; }
/// The same of counts of errors: rises with the table of errors, too.
constexpr std::uint32_t errorVersion(std::uint32_t own) { return judgedVersion(own) + errorRulesVersion; }

/// "at least 90 % of the window", or empty: the figure isn't of samples.
std::string coverageText(const CheckpointDefinition& definition);

struct Motion;
struct PhaseMotion;
class ForceTrack;
class PhaseForceTrack;

/// Facts known after the last step (or, for provisional values, after the newest one).
struct AttemptEnd {
  std::uint64_t steps = 0;
  double stretched = 0.0;  ///< by how much lag stretched the tick clock (s): more wall time passed than ticks say
  recorder::Outcome outcome = recorder::Outcome::running;
  Origin origin = Origin::resimulated;            ///< of forces and contacts; motion is always `samples`
  std::array<const Motion*, handCount> motion{};  ///< both hands' motion, never null (checkpoints/motion.h)
  /// The same for each phase of a procedure, in its order (checkpoints/phases.h), never null.
  const std::vector<PhaseMotion>* phases = nullptr;
  const ForceTrack* force = nullptr;            ///< haptic forces of both hands, never null (collector.h)
  const PhaseForceTrack* phaseForce = nullptr;  ///< the same of each phase, never null
};

/// Accumulator of a figure, step by step. Deterministic contract: IEEE + - * / sqrt in source-fixed order, so that
/// a replay gives the bits that the live run gave. accumulating() makes one of a plain struct.
class Accumulator {
 public:
  virtual ~Accumulator() = default;
  virtual void add(const recorder::StepRecord& record, const Judgement& judgement) = 0;
  /// The figure so far of one of the row's subjects.
  [[nodiscard]] virtual Measured figure(const AttemptEnd& end, std::size_t subject,
                                        const CheckpointDefinition& definition) const = 0;
};
using AccumulatorMaker = std::function<std::unique_ptr<Accumulator>(const AttemptContext& context)>;

/// An accumulator by a struct A that has
/// - add(result), add(record) or add(record, judgement), called once per step, in order; or none of them: motion and
///   haptic forces are collected once for all (AttemptEnd);
/// - figure(), figure(end), figure(subject), figure(end, subject) or figure(end, subject, definition).
template <class A>
class AccumulatorOf final : public Accumulator {
 public:
  explicit AccumulatorOf(A accumulator) : a_(std::move(accumulator)) {}

  void add(const recorder::StepRecord& record, const Judgement& judgement) override {
    if constexpr (requires(A & a) { a.add(record, judgement); }) {
      a_.add(record, judgement);
    } else if constexpr (requires(A & a) { a.add(record); }) {
      a_.add(record);
    } else if constexpr (requires(A & a) { a.add(record.result); }) {
      a_.add(record.result);
    }
  }
  [[nodiscard]] Measured figure(const AttemptEnd& end, std::size_t subject,
                                const CheckpointDefinition& definition) const override {
    if constexpr (requires(const A& a) { a.figure(end, subject, definition); }) {
      return a_.figure(end, subject, definition);
    } else if constexpr (requires(const A& a) { a.figure(end, subject); }) {
      return a_.figure(end, subject);
    } else if constexpr (requires(const A& a) { a.figure(subject); }) {
      return a_.figure(subject);
    } else if constexpr (requires(const A& a) { a.figure(end); }) {
      return a_.figure(end);
    } else {
      return a_.figure();
    }
  }

 private:
  A a_;
};

/// Makes A{context, arguments...}, or A{arguments...} of an A that needs no context.
template <class A, class... Arguments>
AccumulatorMaker accumulating(Arguments... arguments) {
  return [arguments...]([[maybe_unused]] const AttemptContext& context) -> std::unique_ptr<Accumulator> {
    if constexpr (requires { A{context, arguments...}; }) {
      return std::make_unique<AccumulatorOf<A>>(A{context, arguments...});
    } else {
      return std::make_unique<AccumulatorOf<A>>(A{arguments...});
    }
  };
}

/// Families of checkpoints, in the order in which tables show them.
enum class CheckpointFamily : std::uint8_t {
  paper,      ///< the paper's Table 2, in its order
  motion,     ///< of the hands
  phases,     ///< figures of each phase
  contact,    ///< contact and force
  safety,     ///< errors and safety
  exactness,  ///< how exact the simulation was
};

std::string nameOf(CheckpointFamily family);  ///< "Table 2", "motion", "contact and force"

/// Group of a checkpoint in tables.
struct CheckpointPlace {
  CheckpointFamily family = CheckpointFamily::paper;
  int rank = 0;  ///< within the family, ascending, none twice; steps of ten leave room between them
  /// Word at the head of its columns in the closing table of attempts, in which it then stands: one column for the
  /// attempt, or for each hand or organ. Empty: not in that table.
  std::string_view summaryTitle = {};
};

/// Precondition of a figure, and the reason given where it does not hold.
struct Requirement {
  bool (*met)(const AttemptContext& context);
  const char* otherwise;
};

class Checkpoint;

/// One row of the table of checkpoints: declaration, precondition, computation. The files of
/// analytics/checkpoints/figures hold the rows (docs/extending/checkpoint.md).
struct CheckpointEntry {
  CheckpointPlace place;
  CheckpointDefinition definition;      ///< empty texts and origins: as completed() fills them
  std::vector<Requirement> needs = {};  ///< the first that is not met gives the reason
  std::uint32_t results = 0;            ///< least version of the StepResults that it reads
  AccumulatorMaker accumulate = {};
  /// Names of what it is given for; null: by the aggregation, organs being all structures.
  std::vector<std::string> (*subjects)(const AttemptContext& context) = nullptr;
  bool ofAbsentPhases = false;  ///< a phase that the attempt has not has a figure too

  /// @pre the entry outlives what is made.
  [[nodiscard]] std::unique_ptr<Checkpoint> make(const AttemptContext& context) const;
};

/// The definition with what its row leaves out: window "whole attempt", "union over instruments", filter "none",
/// origins of steps, displayed in its own unit; and the factor of the unit in which it is displayed.
CheckpointDefinition completed(CheckpointDefinition definition);

/// One running computation of one entry over one attempt.
class Checkpoint {
 public:
  Checkpoint(const CheckpointEntry& entry, AttemptContext context);
  Checkpoint(const Checkpoint&) = delete;
  Checkpoint& operator=(const Checkpoint&) = delete;

  /// Called once per step, in order, with what was judged of it.
  void onStep(const recorder::StepRecord& record, const Judgement& judgement);
  /// The figures so far: one per subject, in the order of hands or organs. May be called more than once.
  [[nodiscard]] std::vector<CheckpointValue> values(const AttemptEnd& end) const;

 private:
  [[nodiscard]] Measured measured(const AttemptEnd& end, std::size_t subject) const;

  const CheckpointEntry& entry_;
  AttemptContext context_;
  std::string notApplicable_;
  std::vector<std::string> subjects_;
  std::unique_ptr<Accumulator> accumulator_;  ///< null where it is not applicable
};

/// Remark on a time where the tick clock was stretched ("tick clock stretched by 0.340 s"), or empty.
std::string stretchNote(const AttemptEnd& end);

/// Builders of values, with name, version, unit and filter taken from the definition.
CheckpointValue makeValue(const CheckpointDefinition& definition, std::string subject, Origin origin, double value,
                          std::string note = {});
CheckpointValue makeMissing(const CheckpointDefinition& definition, std::string subject, Origin origin,
                            Availability availability, std::string reason);

/// Names of the entry's values: hands, phases, the context's organs; one empty name: the attempt.
std::vector<std::string> subjectsOf(const CheckpointEntry& entry, const AttemptContext& context);

/// Every checkpoint that this build knows, in the order in which tables show them: by family, then by rank.
const std::vector<CheckpointEntry>& checkpointRegistry();

/// The definition of a name, or null.
const CheckpointDefinition* findCheckpoint(std::string_view name);
/// Its place in the registry, whose size stands for a name that is not in it.
std::size_t positionOf(std::string_view name);

/// The definition that a value stands on: the registry's, or of an external metric its script's; or null. It lives as
/// long as the value.
const CheckpointDefinition* definitionOf(const CheckpointValue& value);

/// The family of a name, or none.
std::optional<CheckpointFamily> familyOf(std::string_view name);

/// Given for each phase of a procedure, not of the whole attempt.
bool isOfPhases(const CheckpointDefinition& definition);
/// Names of those, in the registry's order.
const std::vector<std::string>& phaseCheckpoints();

}  // namespace calot::analytics
