// SPDX-License-Identifier: GPL-3.0-or-later
// What a checkpoint is: one figure of an attempt (or one per hand, or one per organ), computed from the stream of
// steps. docs/reference/metrics.md gives the formula, source and pitfalls of each; a test holds it against the
// registry.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analytics/checkpoints/definition.h"
#include "analytics/checkpoints/external_metric.h"
#include "analytics/checkpoints/scene_facts.h"
#include "recorder/base/identity.h"
#include "recorder/engine/observer.h"
#include "sim/judgement/judge.h"

namespace calot::analytics {

/// Whether there is a number, and what kind of missing it is. Numbers are stored and never reused.
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
  ExternalMetricRef metric = {};  ///< of origin `external`, and of no other
  bool operator==(const CheckpointValue&) const = default;
};

/// What is known before the first step.
struct AttemptContext {
  double tickSeconds = tickLength;
  std::uint32_t ticksPerStep = 10;
  std::vector<std::string> structures;  ///< organs, vessels, fat: as bits of `touching` and subjects of events count
  std::uint32_t resultVersion = 0;      ///< of the StepResults
  bool procedure = false;               ///< the scene has a procedure
  std::string handedness = "unknown";   ///< as recorded: "right", "left", "unknown"
  SceneFacts scene;
};

/// Empty when results of `needed` or later are there; else why a checkpoint that reads them is not applicable.
std::string whyTooOld(const AttemptContext& context, std::uint32_t needed);

/// Version of a definition that stands on judgement (phases, critical view, errors): rises with the rules' own.
constexpr std::uint32_t judgedVersion(std::uint32_t own) { return own + judgementVersion - 1; }

/// "at least 90 % of the window", or empty: the figure isn't of samples.
std::string coverageText(const CheckpointDefinition& definition);

struct Motion;
struct PhaseMotion;
class ForceTrack;
class PhaseForceTrack;

/// What is known after the last step (or, for provisional values, after the newest one).
struct AttemptEnd {
  std::uint64_t steps = 0;
  double stretched = 0.0;  ///< by how much lag stretched the tick clock (s): more wall time passed than ticks say
  recorder::Outcome outcome = recorder::Outcome::running;
  Origin origin = Origin::resimulated;            ///< of forces and contacts; motion is always `samples`
  std::array<const Motion*, handCount> motion{};  ///< both hands' motion, never null (checkpoints/motion.h)
  /// The same for each phase of a procedure, in its order (checkpoints/phases.h), never null.
  const std::vector<PhaseMotion>* phases = nullptr;
  const ForceTrack* force = nullptr;            ///< haptic forces of both hands, never null (checkpoints/force.h)
  const PhaseForceTrack* phaseForce = nullptr;  ///< the same of each phase, never null
};

/// One running computation of one definition over one attempt. Deterministic contract: IEEE + - * / sqrt in
/// source-fixed order, so that a replay gives the bits that the live run gave.
class Checkpoint {
 public:
  virtual ~Checkpoint() = default;
  /// Called once per step, in order, with what was judged of it. Motion and haptic forces are collected once for all:
  /// AttemptEnd has them.
  virtual void onStep(const recorder::StepRecord& record, const Judgement& judgement);
  /// The figures so far: one per subject, in the order of hands or organs. May be called more than once.
  [[nodiscard]] virtual std::vector<CheckpointValue> values(const AttemptEnd& end) const = 0;
};

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

/// Where tables show a checkpoint.
struct CheckpointPlace {
  CheckpointFamily family = CheckpointFamily::paper;
  int rank = 0;  ///< within the family, ascending, none twice; steps of ten leave room between them
  /// Word at the head of its columns in the closing table of attempts, in which it then stands: one column for the
  /// attempt, or for each hand or organ. Empty: not in that table.
  std::string_view summaryTitle = {};
};

/// One checkpoint: its declaration, and how to make it. Each file of analytics/checkpoints/figures defines a function,
/// named after the file, that returns its entries: `pathLengthEntries` in path_length.cpp. CMake lists these functions
/// for the registry (docs/extending/index.md).
struct CheckpointEntry {
  CheckpointPlace place;
  CheckpointDefinition definition;
  std::unique_ptr<Checkpoint> (*make)(const AttemptContext& context);
};

/// What a reader of a time must know where the tick clock was stretched ("tick clock stretched by 0.340 s"), or empty.
std::string stretchNote(const AttemptEnd& end);

/// Builders of values, with name, version, unit and filter taken from the definition.
CheckpointValue makeValue(const CheckpointDefinition& definition, std::string subject, Origin origin, double value,
                          std::string note = {});
CheckpointValue makeMissing(const CheckpointDefinition& definition, std::string subject, Origin origin,
                            Availability availability, std::string reason);

}  // namespace calot::analytics
