// SPDX-License-Identifier: GPL-3.0-or-later
// Files of a cohort: the recordings of its attempts, and all files of a participant who withdraws.
// Shares of a list of recordings: each machine assesses one into a database of its own (docs/how-to/cluster.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
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
  /// Errors of files that are damaged or not recordings.
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

/// One share of several, counted from 1: "3/8".
struct Share {
  std::uint32_t number = 1, of = 1;
  bool operator==(const Share&) const = default;
};

/// Largest number of shares; no cluster runs a larger array of jobs.
inline constexpr std::uint32_t maxShares = 1'000'000;

/// Reads "3/8". @throws Error (invalid)
Share shareNamed(const std::string& text);

/// Indices of the files in a share, ascending. Sorted by size and name, files are dealt like cards, forth and back, so
/// that shares differ by at most one file and hold as many long recordings each. Depends on the list alone.
/// @param files size (bytes) and name of each
std::vector<std::size_t> indicesOf(const Share& share, const std::vector<std::pair<std::uint64_t, std::string>>& files);

/// Files of a share. @throws nothing: a file that is gone counts as empty, and judging it reports it.
std::vector<std::filesystem::path> filesOf(const Share& share, const std::vector<std::filesystem::path>& files);

}  // namespace calot::analytics
