// SPDX-License-Identifier: GPL-3.0-or-later
// How motion without a scene enters the cohort database.
// A command line or a table declares it in words.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/external/metric_script.h"
#include "recorder/sources/tracked_motion.h"

namespace calot::analytics {

/// What the caller says of motion files: they don't say it themselves.
struct MotionDeclaration {
  std::string task = "unnamed-task";  ///< what was done; attempts of different tasks are never compared
  std::string participant;            ///< pseudonym, or empty
  recorder::Mode mode = recorder::Mode::practice;
  std::string purpose = "training";
  std::string handedness = "unknown";
  recorder::Outcome outcome = recorder::Outcome::stopped;
  std::string startUtc;  ///< ISO 8601 with Z, or empty: not known
};

/// The row of the database: operator kind `kinematics`, no simulation, not checkable here (there is nothing to simulate
/// again). The attempt's uuid (version 8 of RFC 9562) and chain head are the SHA-256 of the file's bytes, so the same
/// file is the same attempt whatever its name.
AttemptRecord recordOf(const recorder::TrackedMotion& motion, const MotionDeclaration& declaration);

/// Computes the motion's checkpoints and stores them; one transaction, idempotent.
/// @return what was stored, and whether it was there already. @throws Error (refused) on a conflict
/// (CohortDatabase::storeAttempt).
struct StoredMotion {
  Imported imported = Imported::unchanged;
  std::vector<CheckpointValue> values;
};
StoredMotion storeMotion(CohortDatabase& database, const recorder::TrackedMotion& motion,
                         const MotionDeclaration& declaration);

/// What external metrics make of the motion.
MetricOutcomes externalOf(const recorder::TrackedMotion& motion, const MotionDeclaration& declaration,
                          const std::vector<MetricScript>& metrics);

/// Sets one field of a declaration from its word: "task", "participant", "mode", "purpose", "handedness", "outcome" or
/// "start". An empty word leaves the field as it is.
/// @return empty, or what is wanted instead; then nothing is set
/// @pre `field` is one of these.
std::string declareMotion(MotionDeclaration& declaration, std::string_view field, const std::string& word);

}  // namespace calot::analytics
