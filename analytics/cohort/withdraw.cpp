// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/cohort/withdraw.h"

#include <fmt/format.h>
#include <sodium.h>
#include <SQLiteCpp/Backup.h>
#include <algorithm>
#include <filesystem>
#include <system_error>

#include "analytics/cohort/tables.h"
#include "recorder/base/counted.h"
#include "recorder/loop.h"

namespace calot::analytics {
namespace {

using namespace tables;

bool namesAny(const std::string& text, const std::vector<std::string>& words) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) { return namesWord(text, word); });
}

/// Calls work(table, column) for each column of text.
template <class Work>
void eachTextColumn(SQLite::Database& db, Work work) {
  for (const TableFacts& table : readTables(db)) {
    for (const ColumnFacts& column : table.columns) {
      if (column.type == "TEXT") work(table.name, column);
    }
  }
}

/// Deletes rows whose parent is gone, in all tables, until none is left.
void deleteOrphans(SQLite::Database& db) {
  for (bool changed = true; changed;) {
    changed = false;
    for (const TableFacts& table : readTables(db)) {
      for (const ForeignKey& key : table.foreign) {
        const std::string orphans = fmt::format(
            "DELETE FROM {0} WHERE {1} IS NOT NULL AND {1} NOT IN (SELECT {2} FROM {3})", quotedName(table.name),
            quotedName(key.column), quotedName(key.parentColumn), quotedName(key.parent));
        if (execute(db, orphans) > 0) changed = true;
      }
    }
  }
}

/// Rows of tables that name an attempt by its uuid without a foreign key.
void deleteByUuid(SQLite::Database& db, const std::string& uuid) {
  eachTextColumn(db, [&](const std::string& table, const ColumnFacts& column) {
    if (table == "audit" || table == "export") return;
    execute(db, fmt::format("DELETE FROM {} WHERE {} = ?", quotedName(table), quotedName(column.name)), {uuid});
  });
}

void silenceAudit(SQLite::Database& db, const std::vector<std::string>& words, const std::string& subject) {
  std::vector<std::int64_t> rows;
  eachRow(db, "SELECT id, subject, detail FROM audit", {}, [&](SQLite::Statement& row) {
    const std::string about = text(row.getColumn(1));
    const bool whole = std::find(words.begin(), words.end(), about) != words.end();
    if (whole || namesAny(about, words) || namesAny(text(row.getColumn(2)), words))
      rows.push_back(row.getColumn(0).getInt64());
  });
  for (const std::int64_t row : rows)
    execute(db, "UPDATE audit SET subject = ?, detail = '' WHERE id = ?", {subject, row});
}

const char* nameOf(WithdrawalScope scope) { return scope == WithdrawalScope::all ? "all" : "research"; }

/// @returns its id: that of a withdrawal of these attempts which was announced or interrupted before, or a new one
std::string leaveTombstone(SQLite::Database& db, const Withdrawal& w) {
  std::string id;
  for (std::size_t i = 0; i < w.attempts.size() && id.empty(); ++i) {
    const auto known = firstTexts(db,
                                  "SELECT t.id FROM tombstone t JOIN tombstone_attempt a ON a.tombstone = t.id WHERE "
                                  "a.digest = ? AND t.scope = ?",
                                  {blobOf(withdrawalDigest(w.attempts[i])), nameOf(w.scope)});
    if (!known.empty()) id = known.front();
  }
  if (id.empty()) {
    id = recorder::newUuid();
    execute(db, "INSERT INTO tombstone VALUES (?, ?, ?, 0)", {id, nowUtc(), nameOf(w.scope)});
  }
  for (const std::string& uuid : w.attempts) {
    execute(db, "INSERT INTO tombstone_attempt VALUES (?, ?) ON CONFLICT DO NOTHING",
            {blobOf(withdrawalDigest(uuid)), id});
  }
  execute(db,
          "UPDATE tombstone SET attempts = (SELECT count(*) FROM tombstone_attempt WHERE tombstone = ?1) WHERE id = ?1",
          {id});
  return id;
}

/// The participant stays, without any research data.
void leaveResearch(SQLite::Database& db, const std::string& pseudonym) {
  const std::int64_t id = participantId(db, pseudonym);
  for (const char* sql : {"UPDATE participant SET study_group = '', arm = '' WHERE id = ?",
                          "DELETE FROM cohort_participant WHERE participant = ?",
                          "DELETE FROM consent WHERE participant = ? AND purpose IN ('research', 'study')"})
    execute(db, sql, {id});
  execute(db, "INSERT INTO research_withdrawal VALUES (?, ?) ON CONFLICT DO NOTHING", {id, nowUtc()});
}

void removeBackups(const std::string& path) {
  for (const std::string& backup : backupsOf(path)) {
    std::error_code failed;
    if (!std::filesystem::remove(backup, failed) || failed) {
      throw Error(
          ErrorKind::failure, Where{backup},
          fmt::format("cannot be removed ({}); it holds what was withdrawn, remove it by hand", failed.message()));
    }
  }
}

/// Deleted content must not remain in free pages.
void rebuild(SQLite::Database& db, const std::string& path) {
  try {
    db.exec("VACUUM");
  } catch (const SQLite::Exception& error) {
    if (isBusy(error))
      throw Error(ErrorKind::failure, Where{path},
                  "another program reads it, so that what was deleted cannot be overwritten", {Remedy::endReader});
    throw;
  }
}

/// Within a transaction: every row that hangs on the withdrawal, and the words of audit rows that name it.
/// @param id of its tombstone
void removeRows(SQLite::Database& db, const Withdrawal& w, const std::string& id) {
  db.exec("PRAGMA defer_foreign_keys = ON");
  for (const std::string& uuid : w.attempts) execute(db, "DELETE FROM attempt WHERE uuid = ?", {uuid});
  if (w.scope == WithdrawalScope::all) {
    execute(db, "DELETE FROM participant WHERE pseudonym = ?", {w.pseudonym});
  } else {
    leaveResearch(db, w.pseudonym);
  }
  deleteOrphans(db);
  for (const std::string& uuid : w.attempts) deleteByUuid(db, uuid);
  deleteOrphans(db);
  for (const ExportRow& row : w.exports) {
    execute(db,
            "DELETE FROM export WHERE at_utc = ? AND kind = ? AND target = ? AND id NOT IN "
            "(SELECT export FROM export_attempt)",
            {row.utc, row.kind, row.target});
  }
  std::vector<std::string> words = w.attempts;
  if (w.scope == WithdrawalScope::all) words.push_back(w.pseudonym);
  silenceAudit(db, words, "withdrawn " + id);
}

std::vector<std::string> columnsNaming(SQLite::Database& db, const std::vector<std::string>& words) {
  std::vector<std::string> places;
  eachTextColumn(db, [&](const std::string& table, const ColumnFacts& column) {
    if (column.isTime()) return;
    const std::vector<std::string> texts =
        firstTexts(db, fmt::format("SELECT DISTINCT {} FROM {}", quotedName(column.name), quotedName(table)));
    if (std::any_of(texts.begin(), texts.end(), [&](const std::string& held) { return namesAny(held, words); }))
      places.push_back(table + "." + column.name);
  });
  return places;
}

CohortConnection openForDeletion(const std::string& path) {
  CohortConnection cohort(path, CohortDatabase::Access::write);
  cohort.read([](SQLite::Database& db) { db.exec("PRAGMA secure_delete = ON"); });
  return cohort;
}

}  // namespace

bool isInWord(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '-' ||
         static_cast<unsigned char>(c) >= 0x80;
}

bool namesWord(const std::string& where, const std::string& word) {
  if (word.empty()) return false;
  for (std::size_t at = where.find(word); at != std::string::npos; at = where.find(word, at + 1)) {
    const bool begins = at == 0 || !isInWord(where[at - 1]) || !isInWord(word.front());
    const std::size_t end = at + word.size();
    const bool ends = end == where.size() || !isInWord(where[end]) || !isInWord(word.back());
    if (begins && ends) return true;
  }
  return false;
}

std::vector<std::string> backupsOf(const std::string& path) {
  const std::filesystem::path file(path);
  const std::string stem = file.filename().string() + backupMark;
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  std::vector<std::string> backups;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().filename().string().rfind(stem, 0) == 0)
      backups.push_back(file.has_parent_path() ? entry.path().string() : entry.path().filename().string());
  }
  std::sort(backups.begin(), backups.end());
  return backups;
}

std::string withdraw(const std::string& path, const Withdrawal& w) {
  std::string id;
  CohortConnection cohort = openForDeletion(path);
  cohort.change([&](SQLite::Database& db) {
    id = leaveTombstone(db, w);
    removeRows(db, w, id);
    audit(db, "participant-withdraw", w.scope == WithdrawalScope::all ? "withdrawn " + id : w.pseudonym,
          fmt::format("scope {}, {}", nameOf(w.scope), recorder::counted(w.attempts.size(), "attempt")));
  });
  cohort.read([&](SQLite::Database& db) { rebuild(db, path); });
  removeBackups(path);
  return id;
}

void announceWithdrawal(const std::string& path, const Withdrawal& w) {
  if (w.attempts.empty()) return;
  CohortConnection(path, CohortDatabase::Access::write).change([&](SQLite::Database& db) { leaveTombstone(db, w); });
}

void scrub(const std::string& path) {
  openForDeletion(path).read([&](SQLite::Database& db) { rebuild(db, path); });
  removeBackups(path);
}

std::vector<std::string> placesLeft(const std::string& path, const Withdrawal& w,
                                    const std::vector<std::string>& words) {
  return CohortConnection(path, CohortDatabase::Access::read).read([&](SQLite::Database& from) {
    SQLite::Database copy(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    SQLite::Backup(copy, from).executeStep(-1);
    copy.exec("PRAGMA foreign_keys = ON");
    SQLite::Transaction transaction(copy);
    if (w.known) removeRows(copy, w, leaveTombstone(copy, w));
    return columnsNaming(copy, words);
  });
}

bool wasWithdrawn(const std::string& path, const std::string& uuid) {
  return CohortConnection(path, CohortDatabase::Access::read).read([&](SQLite::Database& db) {
    return isWithdrawn(db, uuid);
  });
}

void recordExport(const std::string& path, const std::string& kind, const std::string& target,
                  const std::vector<std::string>& attempts) {
  std::error_code ignored;
  const std::string place = std::filesystem::absolute(target, ignored).lexically_normal().string();
  CohortConnection(path, CohortDatabase::Access::write).change([&](SQLite::Database& db) {
    execute(db, "INSERT INTO export (at_utc, kind, target) VALUES (?, ?, ?)", {nowUtc(), kind, place});
    const std::int64_t id = db.getLastInsertRowid();
    for (const std::string& uuid : attempts) {
      execute(db, "INSERT INTO export_attempt VALUES (?, ?) ON CONFLICT DO NOTHING",
              {id, knownAttempt(db, path, uuid)});
    }
  });
}

Withdrawal planWithdrawal(const std::string& path, const std::string& pseudonym, WithdrawalScope scope,
                          std::optional<bool> assessments) {
  return CohortConnection(path, CohortDatabase::Access::write).read([&](SQLite::Database& db) {
    Withdrawal w;
    w.pseudonym = pseudonym;
    w.scope = scope;
    const std::int64_t id = participantId(db, pseudonym);
    w.known = id >= 0;
    if (!w.known) return w;
    const auto earlier = firstTexts(db, "SELECT withdrawn_utc FROM research_withdrawal WHERE participant = ?", {id});
    if (!earlier.empty()) w.earlierUtc = earlier.front();
    const bool consented =
        firstNumber(db, "SELECT 1 FROM consent WHERE participant = ? AND purpose IN ('research', 'study')", {id}) == 1;
    const bool assessmentsGo = assessments ? !*assessments : consented;
    // Attempts that branch from one of these, from those, and so on, go with them.
    const std::string gone =
        "WITH RECURSIVE gone (uuid) AS (SELECT uuid FROM attempt WHERE participant = ?1 AND (?2 OR purpose <> "
        "'training' OR (mode = 1 AND ?3)) UNION SELECT a.uuid FROM attempt a JOIN gone ON a.parent_uuid = gone.uuid) ";
    const std::vector<Cell> whose{id, scope == WithdrawalScope::all ? 1 : 0, assessmentsGo ? 1 : 0};
    w.attempts = firstTexts(db, gone + "SELECT uuid FROM gone ORDER BY uuid", whose);
    w.branchesOfOthers =
        firstTexts(db, gone + "SELECT uuid FROM attempt WHERE participant <> ?1 AND uuid IN gone ORDER BY uuid", whose);
    eachRow(db, gone + "SELECT uuid, mode FROM attempt WHERE participant = ?1 AND uuid NOT IN gone ORDER BY uuid",
            whose, [&](SQLite::Statement& row) {
              const bool assessment = row.getColumn(1).getInt() == 1;
              w.staying.emplace_back(text(row.getColumn(0)), assessment ? "assessment" : "practice");
              if (assessment && !assessments) w.undecided.push_back(w.staying.back().first);
            });
    eachRow(db,
            gone +
                "SELECT e.at_utc, e.kind, e.target, max(a.uuid IN gone) FROM export e JOIN export_attempt x ON "
                "x.export = e.id JOIN attempt a ON a.id = x.attempt WHERE a.participant = ?1 OR a.uuid IN gone GROUP "
                "BY 1, 2, 3 ORDER BY 1, 2, 3",
            whose, [&](SQLite::Statement& row) {
              w.exports.push_back({text(row.getColumn(0)), text(row.getColumn(1)), text(row.getColumn(2)),
                                   row.getColumn(3).getInt() == 1});
            });
    return w;
  });
}

}  // namespace calot::analytics

namespace calot::analytics::tables {

std::array<std::byte, 32> withdrawalDigest(const std::string& uuid) {
  [[maybe_unused]] static const int ready = sodium_init();
  const std::string text = "calot-withdrawn-1 " + uuid;
  std::array<std::byte, 32> digest{};
  crypto_generichash(reinterpret_cast<unsigned char*>(digest.data()), digest.size(),
                     reinterpret_cast<const unsigned char*>(text.data()), text.size(), nullptr, 0);
  return digest;
}

bool isWithdrawn(SQLite::Database& db, const std::string& uuid) {
  return firstNumber(db, "SELECT 1 FROM tombstone_attempt WHERE digest = ?", {blobOf(withdrawalDigest(uuid))}) == 1;
}

}  // namespace calot::analytics::tables
