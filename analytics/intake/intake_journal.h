// SPDX-License-Identifier: GPL-3.0-or-later
// Result for each file of a watched folder, kept over restarts (docs/how-to/cluster.md, "Watching a folder").
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

namespace calot::analytics {

/// State of a file, to detect changes.
struct FileState {
  std::uint64_t bytes = 0;
  std::int64_t modified = 0;  ///< ns since 1970
  std::uint64_t inode = 0;
  bool operator==(const FileState&) const = default;
};
/// All zero where there is no such file.
FileState fileState(const std::filesystem::path& file);

struct JournalEntry {
  FileState state;
  std::uint32_t tries = 0;              ///< that failed, of this state; 0: it was decided
  std::int64_t retryAt = 0;             ///< s since 1970, where tries > 0
  bool otherVersion = false;            ///< undecided: of another simulation version than `simulationVersion`
  std::uint32_t simulationVersion = 0;  ///< of the program that decided
  bool operator==(const JournalEntry&) const = default;
};

/// One entry a file, the newest counts. A text file of one JSON row a line, each with a checksum:
/// `{"sum":"<XXH3-64 of the row's text, 16 hex digits>","row":<row>}`. Entries are appended; a line that was cut off,
/// and what comes after damage, is dropped: those files are looked at again, and the cohort knows what it has. One
/// program at a time has the journal.
class IntakeJournal {
 public:
  /// Opens or makes it. @throws Error (failure), where another program has it or it cannot be written; (damaged) where
  /// it is another file.
  explicit IntakeJournal(std::filesystem::path path);
  ~IntakeJournal();

  /// Null: nothing is known of the file.
  [[nodiscard]] const JournalEntry* find(const std::string& file) const;
  /// After it returned, the entry outlives the program. @throws Error (failure)
  void put(const std::string& file, const JournalEntry& entry);

 private:
  class LineAppender;
  void load();
  /// Writes what counts into a new file, without files that are gone.
  void compact();

  std::filesystem::path path_;
  std::unique_ptr<LineAppender> out_;
  std::map<std::string, JournalEntry> entries_;
  std::uint64_t lines_ = 0;
};

}  // namespace calot::analytics
