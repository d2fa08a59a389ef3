// SPDX-License-Identifier: GPL-3.0-or-later
// Where the recordings of a cohort's attempts are.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "recorder/errors.h"
#include "recorder/live/worker_pool.h"
#include "recorder/recording/identify.h"

namespace calot::analytics {

/// Recordings by uuid: of several, one with the content that the cohort holds, else the longest.
class RecordingsFound {
 public:
  /// Looks into every file of the places. @throws Error (damaged) where a place is not there
  RecordingsFound(const std::vector<std::filesystem::path>& places, recorder::WorkerPool& pool);
  /// Looks for these attempts alone: first under the names that the cohort knows, and into all files only where one of
  /// them is not found there with the content that the cohort holds. What is found is the same.
  RecordingsFound(const std::vector<std::filesystem::path>& places, const std::vector<const AttemptRow*>& wanted,
                  recorder::WorkerPool& pool);

  [[nodiscard]] std::optional<std::filesystem::path> of(const AttemptRow& attempt) const;
  /// Of files that are no recordings, or damaged; of those that were looked into.
  [[nodiscard]] const std::vector<Error>& notRead() const { return notRead_; }

 private:
  struct Entry {
    std::filesystem::path file;
    recorder::RecordingIdentity identity;
  };
  void lookInto(const std::vector<std::size_t>& files, const std::vector<std::filesystem::path>& places,
                recorder::WorkerPool& pool);

  std::vector<std::filesystem::path> files_;
  std::vector<char> looked_;  ///< into each
  std::map<std::string, std::vector<Entry>> byUuid_;
  std::vector<Error> notRead_;
};

}  // namespace calot::analytics
