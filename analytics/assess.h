// SPDX-License-Identifier: GPL-3.0-or-later
// How the result of one replay enters the cohort database.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/motion.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/external/metric_script.h"
#include "recorder/base/identity.h"
#include "recorder/engine/observer.h"
#include "recorder/recording/identify.h"
#include "recorder/replay.h"

namespace calot::analytics {

/// What assessing one recording gave.
struct AssessedAttempt {
  recorder::AttemptHeader header;
  recorder::Outcome outcome = recorder::Outcome::running;
  bool complete = false;
  std::uint64_t steps = 0;
  std::array<std::byte, 32> chainHead{};
  std::optional<RecordingSignature> signature;  ///< valid
  Verification verification;
  std::vector<CheckpointValue> values;  ///< of CheckpointCollector::values(); empty where the replay diverged
  MetricOutcomes external;              ///< of AssessSettings::metrics; nothing where the replay diverged
  std::string fileName;                 ///< base name or path; the base name is kept
};

/// A replay with the checkpoints watching.
struct Assessment {
  recorder::ReplayReport report;
  std::optional<AssessedAttempt> attempt;  ///< none of a damaged file
};

struct AssessSettings {
  unsigned threads = 1;          ///< segments that are verified at a time
  double cutoff = motionCutoff;  ///< of the motion filter (Hz); values that are stored are of the default
  recorder::EngineWish engine = {};
  const std::vector<MetricScript>* metrics = nullptr;  ///< users' own, computed as well; null: none
  /// May throw, which ends it: what is thrown leaves assessRecording().
  std::function<void(std::uint64_t step, std::uint64_t of)> progress = {};
};

/// Re-simulates a recording and computes its checkpoints. One that diverged has no values; one of another simulation
/// version that no engine here decides has those of its observables, where its content chain is intact.
Assessment assessRecording(const std::string& file, const AssessSettings& settings = {});

/// The stored part of an assessment, and its report.
struct JudgedRecording {
  recorder::ReplayReport report;
  std::optional<AttemptRecord> record;  ///< none of a damaged file
  std::vector<CheckpointValue> values;
  MetricOutcomes external;
};
JudgedRecording judgedRecording(Assessment assessment);

/// Does the cohort hold this recording's content, verified? Then there is nothing to assess.
bool isVerified(const CohortDatabase& database, const recorder::RecordingIdentity& recording);

/// One transaction; idempotent. @throws Error (refused) on a conflict (CohortDatabase::storeAttempt).
Imported store(CohortDatabase& database, const AssessedAttempt& assessed);

/// Stores the values of external metrics, each for itself: one that the cohort refuses becomes a failure.
/// @return whether any is new
bool storeExternal(CohortDatabase& database, const std::string& attempt, MetricOutcomes& external,
                   const std::vector<MetricScript>& metrics);

/// The row that store() writes.
AttemptRecord recordOf(const AssessedAttempt& assessed);

/// Every value of one attempt, in display units, or the reason why there is none; with intervals, two columns more: the
/// interval, and what it is made of.
void printValues(const std::vector<CheckpointValue>& values, const std::vector<ValueInterval>& intervals,
                 std::ostream& out);

/// Closing table of `calot assess`: every attempt of the database with outcome, verification and the checkpoints that
/// ask for columns there (CheckpointPlace::summaryTitle), without those that no attempt has; synthetic ones are marked.
void printAttempts(const CohortDatabase& database, std::ostream& out);

}  // namespace calot::analytics
