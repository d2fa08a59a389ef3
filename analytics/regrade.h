// SPDX-License-Identifier: GPL-3.0-or-later
// Recomputes the derived values of a cohort.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analytics/assess.h"
#include "analytics/checkpoints/checkpoint.h"
#include "analytics/cohort/cohort_database.h"
#include "recorder/base/errors.h"
#include "recorder/live/worker_pool.h"

namespace calot::analytics {

/// A value before and after; one of both may be missing.
struct ValueChange {
  std::optional<CheckpointValue> before, now;

  [[nodiscard]] const CheckpointValue& any() const { return now ? *now : *before; }
};

enum class Regraded : std::uint8_t {
  unchanged,
  changed,
  missing,     ///< its recording is in none of the places
  motion,      ///< motion without a scene: there is no recording, only importing it again recomputes it
  unreadable,  ///< its recording is damaged
  conflict,    ///< its recording diverged, or is not the one that the cohort holds
};

struct RegradedAttempt {
  std::string uuid;
  std::string file;  ///< as the cohort knows it; where it was found, its path
  Regraded how = Regraded::missing;
  std::optional<ErrorKind> fault;  ///< what kind of error stands in the way; none: it could be judged
  std::string message;             ///< why, where it could not be done, or not in full
  std::vector<Remedy> remedies;
  std::vector<ValueChange> changes;
};

struct Regrade {
  std::vector<RegradedAttempt> attempts;  ///< by start, then uuid
  std::vector<Error> notRead;             ///< of files in the places that are no recordings, or damaged
};

/// Re-simulates the recording of every attempt, `jobs` at a time, and brings verification and values up to date; what a
/// person entered is not touched. Attempts are stored in their order, each whole or not at all, so that a run that was
/// cut short is continued by the next. The second run changes nothing. Where this build cannot re-simulate a
/// recording, values that were re-simulated by the same version of their checkpoint stay, and the others come from its
/// observables.
/// @param places files and folders of recordings
/// @param jobs 0: one for each processor
/// @throws Error as CohortDatabase does; damaged where a place is not there
Regrade regrade(const std::string& path, const std::vector<std::filesystem::path>& places, unsigned jobs,
                const std::function<void(std::uint64_t done, std::uint64_t of)>& progress = {});

/// Brings verification and values of a cohort up to date from other databases, into which the same recordings were
/// assessed, by whichever machine: what regrade() would have stored, in the same order. Of several databases that hold
/// an attempt, the one that judged it last counts, and only if that was no earlier than here. Adds no attempts.
/// @throws Error as CohortDatabase does
Regrade takeNewer(const std::string& into, const std::vector<std::string>& from);

/// Re-simulates recordings, as many at a time as the pool has threads, and hands over what they gave in their order,
/// from the calling thread. @throws what `consume` throws; Error (failure)
void judgeAll(const std::vector<std::string>& files, recorder::WorkerPool& pool, const AssessSettings& settings,
              const std::function<void(std::size_t index, JudgedRecording judged)>& consume);

/// Values of both lists that are not the same, in the order of the second, then what is left of the first.
std::vector<ValueChange> changesOf(const std::vector<CheckpointValue>& before, const std::vector<CheckpointValue>& now);

}  // namespace calot::analytics
