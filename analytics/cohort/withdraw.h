// SPDX-License-Identifier: GPL-3.0-or-later
// Taking a participant out of a cohort database for good (docs/cohort.md, "Withdrawal").
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace calot::analytics {

enum class WithdrawalScope : std::uint8_t {
  research,  ///< what was not training goes; the participant stays, out of every study
  all,       ///< everything goes, the participant too
};

/// Something that was written from the database for others to have.
struct ExportRow {
  std::string utc, kind, target;
  bool operator==(const ExportRow&) const = default;
};

/// What a withdrawal takes away.
struct Withdrawal {
  std::string pseudonym;
  WithdrawalScope scope = WithdrawalScope::all;
  bool known = false;                         ///< the database has such a participant
  std::vector<std::string> attempts;          ///< uuids, with every branch of them, whoever made it
  std::vector<std::string> branchesOfOthers;  ///< those of `attempts` that another participant made
  std::vector<ExportRow> exports;             ///< that hold some of these attempts
};

/// Notes that attempts went into a file or folder for others to have. Idempotent within a second.
void recordExport(const std::string& path, const std::string& kind, const std::string& target,
                  const std::vector<std::string>& attempts);

/// What would go; nothing is changed.
Withdrawal planWithdrawal(const std::string& path, const std::string& pseudonym, WithdrawalScope scope);

/// Takes it away, in one transaction: every row that hangs on the attempts (and, of scope `all`, on the participant),
/// the words of audit rows that name them; leaves a tombstone. What was deleted is overwritten, the database is rebuilt
/// and its log emptied; backups that migrations left beside it are removed, as they hold the rows, too.
/// @returns the tombstone's id. @throws Error as CohortDatabase does; (failure) where another program keeps the log
/// busy.
std::string withdraw(const std::string& path, const Withdrawal& withdrawal);

/// Overwrites what earlier deletions left in the file and in its log, and removes the backups of migrations.
void scrub(const std::string& path);

/// Places ("table.column") in which some text of the database still holds one of the words, each as a whole word.
std::vector<std::string> placesNaming(const std::string& path, const std::vector<std::string>& words);

/// Was the attempt withdrawn from this database?
bool wasWithdrawn(const std::string& path, const std::string& uuid);

/// Does the text hold the word, not as part of a longer one? Words are of letters, digits, '_' and '-'.
bool namesWord(const std::string& text, const std::string& word);

}  // namespace calot::analytics
