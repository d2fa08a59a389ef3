// SPDX-License-Identifier: GPL-3.0-or-later
// Files of a cohort: the recordings of its attempts, and all files of a participant who withdraws.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/withdraw.h"
#include "recorder/base/errors.h"
#include "recorder/live/worker_pool.h"
#include "recorder/recording/recording_facts.h"

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

struct WithdrawalFiles {
  /// Recordings of the attempts and of branches of them, also damaged ones that name one; with scope `all`, every
  /// recording of the participant. Then pictures and films beside these, of the same name.
  std::vector<std::filesystem::path> remove;
  /// Other files that are about them: any in whose bytes an attempt's uuid stands; with scope `all`, text in which the
  /// pseudonym stands as a value of its own, files that are called so, and cohort databases that have the participant.
  /// A recording is of whom it says that it is of: its bytes are not searched.
  std::vector<std::filesystem::path> naming;
  /// uuids of the recordings to remove that the database does not know.
  std::vector<std::string> unknown;
};

/// Looks through every file of the folders and below, byte for byte. Changes nothing.
/// @param keep files to leave out: the database, the key file
/// @throws Error damaged: a folder is not there
WithdrawalFiles findFiles(const Withdrawal& withdrawal, const std::string& database,
                          const std::vector<std::filesystem::path>& folders,
                          const std::vector<std::filesystem::path>& keep);

}  // namespace calot::analytics
