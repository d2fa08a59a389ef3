// SPDX-License-Identifier: GPL-3.0-or-later
// How the result of one replay, and motion without a scene, enter the cohort database.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/motion.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/external/metric_script.h"
#include "recorder/base/identity.h"
#include "recorder/engine/observer.h"
#include "recorder/recording/recording_facts.h"
#include "recorder/replay.h"
#include "recorder/sources/tracked_motion.h"

namespace calot::analytics {

/// A replay with the checkpoints watching: its report, and what of it a cohort stores.
struct JudgedRecording {
  recorder::ReplayReport report;
  std::optional<AttemptRecord> record;  ///< none of a damaged file
  std::vector<CheckpointValue> values;  ///< of CheckpointCollector::values(); empty where the replay diverged
  MetricOutcomes external;              ///< of AssessSettings::metrics; nothing where the replay diverged
};

struct AssessSettings {
  unsigned threads = 1;          ///< segments that are verified at a time
  double cutoff = motionCutoff;  ///< of the motion filter (Hz); values that are stored are of the default
  recorder::EngineRequest engine = {};
  const std::vector<MetricScript>* metrics = nullptr;  ///< users' own, computed as well; null: none
  /// For judgeAll() it counts thousandths of all recordings, from any of its threads. May throw, which ends it: what is
  /// thrown leaves assessRecording().
  std::function<void(std::uint64_t step, std::uint64_t of)> progress = {};
};

/// Re-simulates a recording and computes its checkpoints: what command line, windows, Python and watched folders ask. A
/// recording that diverged has no values; one of another simulation version that no engine here decides has those of
/// its observables, where its content chain is intact. CohortDatabase::storeAttempt() stores record and values.
JudgedRecording assessRecording(const std::string& file, const AssessSettings& settings = {});

/// A replay's verdict as a database keeps it, and back.
Verdict verdictOf(recorder::ReplayVerdict verdict);
recorder::ReplayVerdict verdictOf(Verdict verdict);

/// Does the cohort hold this recording's content, verified? Then there is nothing to assess.
bool isVerified(const CohortDatabase& database, const recorder::RecordingIdentity& recording);

/// The row of an attempt in a cohort. @param report of its replay: outcome, extent, chain head, signature and verdict
/// @param file name or path; the base name is kept
AttemptRecord recordOf(const recorder::AttemptHeader& header, const recorder::ReplayReport& report,
                       const std::string& file);

/// Stores the values of external metrics, each for itself: one that the cohort refuses becomes a failure.
/// @return whether any is new
bool storeExternal(CohortDatabase& database, const std::string& attempt, MetricOutcomes& external,
                   const std::vector<MetricScript>& metrics);

/// Facts about motion files supplied by the caller.
struct MotionDeclaration {
  std::string task = "unnamed-task";  ///< what was done; attempts of different tasks are never compared
  std::string participant;            ///< pseudonym, or empty
  recorder::Mode mode = recorder::Mode::practice;
  std::string purpose;  ///< empty: study where the participant has consented to study or research, else training
  std::string handedness = "unknown";
  recorder::Outcome outcome = recorder::Outcome::stopped;
  std::string startUtc;  ///< ISO 8601 with Z, or empty: not known
};

/// The row of the database: operator kind `kinematics`, no simulation, not checkable here (there is nothing to simulate
/// again). The attempt's uuid (version 8 of RFC 9562) is of the SHA-256 of the decoded samples, so the same motion is
/// the same attempt whatever its file's name, line ends, units and further columns; the chain head is that of the
/// bytes.
AttemptRecord recordOf(const recorder::TrackedMotion& motion, const MotionDeclaration& declaration);

/// Computes the motion's checkpoints and stores them; one transaction, idempotent.
/// @return what was stored, and whether it was there already. @throws Error (refused) on a conflict
/// (CohortDatabase::storeAttempt).
struct StoredMotion {
  std::string attempt;  ///< uuid; of motion that the cohort knows already, the uuid there
  Imported imported = Imported::unchanged;
  std::vector<CheckpointValue> values;
};
StoredMotion storeMotion(CohortDatabase& database, const recorder::TrackedMotion& motion,
                         const MotionDeclaration& declaration);

/// Values of external metrics for the motion.
MetricOutcomes externalOf(const recorder::TrackedMotion& motion, const MotionDeclaration& declaration,
                          const std::vector<MetricScript>& metrics);

/// Sets one field of a declaration from its word: "task", "participant", "mode", "purpose", "handedness", "outcome" or
/// "start". An empty word leaves the field as it is.
/// @return empty, or what is wanted instead; then nothing is set
/// @pre `field` is one of these.
std::string declareMotion(MotionDeclaration& declaration, std::string_view field, const std::string& word);

}  // namespace calot::analytics
