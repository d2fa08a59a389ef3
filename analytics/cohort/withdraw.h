// SPDX-License-Identifier: GPL-3.0-or-later
// Permanent removal of a participant from a cohort database (docs/reference/cohort.md, "Withdrawal").
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace calot::analytics {

enum class WithdrawalScope : std::uint8_t {
  research,  ///< removes all but training data; the participant stays but is excluded from every study
             ///< (planWithdrawal() says which attempts are training)
  all,       ///< removes everything, including the participant
};

/// An export from the database for others.
struct ExportRow {
  std::string utc, kind, target;
  bool removed = true;  ///< holds an attempt that goes; else only ones that stay
  bool operator==(const ExportRow&) const = default;
};

/// Data that a withdrawal removes.
struct Withdrawal {
  std::string pseudonym;
  WithdrawalScope scope = WithdrawalScope::all;
  bool known = false;                         ///< the database has such a participant
  std::vector<std::string> attempts;          ///< uuids, including all branches by whomever
  std::vector<std::string> branchesOfOthers;  ///< those of `attempts` that another participant made
  std::vector<ExportRow> exports;             ///< that hold some attempt of the participant
  /// The participant's attempts that stay, each with its mode: their purpose is training.
  std::vector<std::pair<std::string, std::string>> staying;
  std::vector<std::string> undecided;  ///< assessments of purpose training: to be kept or removed, not said yet
  std::string earlierUtc;              ///< when the participant withdrew from research already; or empty
};

/// Registers an export of attempts to a file or folder. Idempotent within a second.
void recordExport(const std::string& path, const std::string& kind, const std::string& target,
                  const std::vector<std::string>& attempts);

/// Lists what would be removed; changes nothing. Of scope `research`, attempts of purpose training stay; but a study
/// analyses those in assessment mode, whatever their purpose: these go with a consent to study or research, and are
/// undecided without one. @param assessments whether these stay, where somebody said so
Withdrawal planWithdrawal(const std::string& path, const std::string& pseudonym, WithdrawalScope scope,
                          std::optional<bool> assessments = {});

/// Leaves the tombstones of the attempts, before any file is removed: what was interrupted does not come in again.
void announceWithdrawal(const std::string& path, const Withdrawal& withdrawal);

/// Takes it away, in one transaction: every row that hangs on the attempts (and, of scope `all`, on the participant),
/// the words of audit rows that name them; leaves a tombstone. What was deleted is overwritten, the database is rebuilt
/// and its log emptied; backups that migrations left beside it are removed, as they hold the rows, too.
/// @returns the tombstone's id. @throws Error as CohortDatabase does; (failure) where another program keeps the log
/// busy.
std::string withdraw(const std::string& path, const Withdrawal& withdrawal);

/// Overwrites what earlier deletions left in the file and in its log, and removes the backups of migrations.
void scrub(const std::string& path);

/// Columns ("table.column") that will contain one of the words as a whole word after withdraw(), tried on a copy in
/// memory; of a participant that is not known, those that do now.
std::vector<std::string> placesLeft(const std::string& path, const Withdrawal& withdrawal,
                                    const std::vector<std::string>& words);

/// Backups that migrations left beside a database, which withdraw() removes.
std::vector<std::string> backupsOf(const std::string& path);

/// True if the attempt was withdrawn from this database.
bool wasWithdrawn(const std::string& path, const std::string& uuid);

/// A letter, beyond ASCII too, a digit, '_' or '-': words consist of these.
bool isInWord(char c);
/// True if the text holds the word, not as part of a longer one.
bool namesWord(const std::string& text, const std::string& word);

}  // namespace calot::analytics
