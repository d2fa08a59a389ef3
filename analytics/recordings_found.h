// SPDX-License-Identifier: GPL-3.0-or-later
// Where the recordings of a cohort's attempts are.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "recorder/base/errors.h"
#include "recorder/live/worker_pool.h"
#include "recorder/recording/identify.h"

namespace calot::analytics {

/// Recordings by uuid: of several, one with the content that the cohort holds, if possible of the name that it knows;
/// else the longest.
class RecordingsFound {
 public:
  /// Looks into every file of the places. @throws Error (damaged) where a place is not there
  RecordingsFound(const std::vector<std::filesystem::path>& places, recorder::WorkerPool& pool);

  /// Nothing where none is there.
  [[nodiscard]] std::optional<std::filesystem::path> of(const AttemptRow& attempt) const;
  /// Of files that are no recordings, or damaged.
  [[nodiscard]] const std::vector<Error>& notRead() const { return notRead_; }

 private:
  struct Entry {
    std::filesystem::path file;
    recorder::RecordingIdentity identity;
  };
  std::map<std::string, std::vector<Entry>> byUuid_;
  std::vector<Error> notRead_;
};

/// Recordings among files and in folders and below, by name: files that are named, and all HDF5 files of folders.
/// @throws Error (damaged) where a place is not there, or no recording in any
std::vector<std::filesystem::path> recordingsUnder(const std::vector<std::filesystem::path>& places);

}  // namespace calot::analytics
