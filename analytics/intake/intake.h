// SPDX-License-Identifier: GPL-3.0-or-later
// Takes the recordings of a station into a cohort as they come: verified, assessed, stored (docs/how-to/cluster.md,
// "Watching a folder"), with the result for each file, kept over restarts.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analytics/assess.h"

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

struct IntakeSettings {
  std::vector<std::filesystem::path> folders;
  std::string cohort;  ///< made where there is none
  std::filesystem::path journal;
  unsigned threads = 1;  ///< segments of a recording that are verified at a time
  bool apart = false;    ///< re-simulate in confined programs: a watched folder takes what anybody puts into it
  /// A finished recording is taken when it has not changed for this long.
  std::chrono::milliseconds quiet{1000};
  /// One that is not finished or cannot be read, when it has not changed for this long: its writer was killed, or its
  /// copy is damaged.
  std::chrono::milliseconds settle{60'000};
};

enum class TakenIn : std::uint8_t {
  added,
  extended,   ///< more of an attempt that the cohort had, or other values
  unchanged,  ///< assessed, and the cohort had it so
  known,      ///< the cohort has this content, verified: it was not re-simulated again
  damaged,    ///< cannot be read; not looked at again until the file changes
  refused,    ///< contradicts the cohort, or was withdrawn from it; likewise
  failed,     ///< the machine stands in the way; tried again later
};

/// Result for one file.
struct IntakeItem {
  std::string file = {};
  TakenIn how = TakenIn::added;
  JudgedRecording judged = {};      ///< report alone where nothing was stored; empty where it was not re-simulated
  std::string attempt = {};         ///< uuid, as far as it is known
  std::optional<Error> fault = {};  ///< why it was not stored
  std::int64_t retryIn = 0;         ///< s, where it failed
};

/// Remaining work after a pass over the folders.
struct IntakeRest {
  std::uint64_t settling = 0;  ///< finished, and changed a moment ago
  std::uint64_t growing = 0;   ///< not finished
  std::uint64_t retries = 0;   ///< failed, and not yet due again
};

/// The queue: what the folders hold, less what the journal and the cohort know. It survives the program: a recording is
/// stored, then reported, then entered in the journal: a process killed at any moment loses none and stores none twice.
class Intake {
 public:
  /// @throws Error as CohortDatabase does, where there is one; failure, where the journal is another program's;
  /// damaged, where a folder is not there.
  explicit Intake(IntakeSettings settings);

  /// Takes what is ready, oldest first. Ends early once `stop` is set: a recording in progress stays in the queue.
  /// @throws Error (damaged) where a folder has gone
  IntakeRest look(const std::function<void(const IntakeItem&)>& tell, const std::atomic<bool>& stop);

 private:
  struct Seen {
    FileState state;
    std::chrono::steady_clock::time_point since;
  };
  struct Candidate {
    std::string file;
    FileState state;
    std::chrono::milliseconds unchanged;
    std::uint32_t tries;
  };
  std::vector<Candidate> candidates(IntakeRest& rest);
  [[nodiscard]] bool isDecided(const std::string& file, const FileState& state, IntakeRest& rest) const;
  /// Nothing where the file has to wait, or `stop` was set.
  std::optional<IntakeItem> take(const Candidate& candidate, IntakeRest& rest, const std::atomic<bool>& stop) const;
  void enter(const IntakeItem& item, const Candidate& candidate);

  IntakeSettings settings_;
  IntakeJournal journal_;
  std::map<std::string, Seen> seen_;  ///< files that are not decided
};

/// Notices that files come into folders and below, or are finished there (inotify). What other machines do to a network
/// file system goes unnoticed, as does anything beyond the system's limit of watches: whoever waits also looks by
/// himself from time to time.
class FolderWatch {
 public:
  explicit FolderWatch(std::vector<std::filesystem::path> folders);
  ~FolderWatch();
  FolderWatch(const FolderWatch&) = delete;
  FolderWatch& operator=(const FolderWatch&) = delete;

  /// Waits until something has changed, the time is over, or a signal came. @returns whether something has changed
  bool wait(std::chrono::milliseconds longest);

 private:
  void watchAll();

  std::vector<std::filesystem::path> folders_;
  int notifier_ = -1;  ///< none: only time passes
};

}  // namespace calot::analytics
