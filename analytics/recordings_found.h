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

/// Files by their names alone, none of which is looked into: where a cohort's recording probably is. Whoever judges it
/// sees whether it is the one.
class NamedFiles {
 public:
  /// @throws Error (damaged) where a place is not there
  explicit NamedFiles(const std::vector<std::filesystem::path>& places);

  /// The only file of this name; nothing where there are none or several.
  [[nodiscard]] std::optional<std::filesystem::path> only(const std::string& name) const;

 private:
  std::multimap<std::string, std::filesystem::path> byName_;
};

}  // namespace calot::analytics
