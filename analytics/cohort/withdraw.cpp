// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/cohort/withdraw.h"

#include <fmt/format.h>
#include <sodium.h>
#include <SQLiteCpp/Backup.h>
#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>
#include <tuple>

#include "analytics/cohort/any_table.h"
#include "analytics/cohort/connection.h"
#include "analytics/cohort/tables.h"
#include "recorder/attempt.h"

namespace calot::analytics {
namespace {

using namespace tables;

constexpr auto withdrawalPatience = std::chrono::seconds(10);

bool wordLetter(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '-' ||
         static_cast<unsigned char>(c) >= 0x80;
}

/// Deletes rows whose parent is gone, in all tables, until none is left.
void deleteOrphans(SQLite::Database& db) {
  for (bool changed = true; changed;) {
    changed = false;
    for (const TableFacts& table : readTables(db)) {
      for (const ForeignKey& key : table.foreign) {
        SQLite::Statement orphans(
            db, fmt::format("DELETE FROM {0} WHERE {1} IS NOT NULL AND {1} NOT IN (SELECT {2} FROM {3})",
                            quotedName(table.name), quotedName(key.column), quotedName(key.parentColumn),
                            quotedName(key.parent)));
        if (orphans.exec() > 0) changed = true;
      }
    }
  }
}

/// Rows of tables that name an attempt by its uuid without a foreign key.
void deleteByUuid(SQLite::Database& db, const std::string& uuid) {
  for (const TableFacts& table : readTables(db)) {
    if (table.name == "audit" || table.name == "export") continue;
    for (const ColumnFacts& column : table.columns) {
      if (column.type != "TEXT") continue;
      SQLite::Statement rows(
          db, fmt::format("DELETE FROM {} WHERE {} = ?", quotedName(table.name), quotedName(column.name)));
      rows.bind(1, uuid);
      rows.exec();
    }
  }
}

void silenceAudit(SQLite::Database& db, const std::vector<std::string>& words, const std::string& subject) {
  std::vector<std::int64_t> rows;
  SQLite::Statement read(db, "SELECT id, subject, detail FROM audit");
  while (read.executeStep()) {
    const std::string about = text(read.getColumn(1)), detail = text(read.getColumn(2));
    const bool named = std::any_of(words.begin(), words.end(), [&](const std::string& word) {
      return about == word || namesWord(about, word) || namesWord(detail, word);
    });
    if (named) rows.push_back(read.getColumn(0).getInt64());
  }
  read.reset();
  SQLite::Statement silence(db, "UPDATE audit SET subject = ?, detail = '' WHERE id = ?");
  for (const std::int64_t row : rows) {
    silence.reset();
    SQLite::bind(silence, subject, row);
    silence.exec();
  }
}

void leaveTombstone(SQLite::Database& db, const std::string& id, const Withdrawal& w) {
  SQLite::Statement put(db, "INSERT INTO tombstone VALUES (?, ?, ?, ?)");
  SQLite::bind(put, id, nowUtc(), w.scope == WithdrawalScope::all ? "all" : "research",
               static_cast<std::int64_t>(w.attempts.size()));
  put.exec();
  SQLite::Statement mark(db, "INSERT INTO tombstone_attempt VALUES (?, ?) ON CONFLICT DO NOTHING");
  for (const std::string& uuid : w.attempts) {
    const std::array<std::byte, 32> digest = withdrawalDigest(uuid);
    mark.reset();
    mark.bind(1, digest.data(), static_cast<int>(digest.size()));
    mark.bind(2, id);
    mark.exec();
  }
}

/// The participant stays, without any research data.
void leaveResearch(SQLite::Database& db, const std::string& pseudonym) {
  const std::int64_t id = participantId(db, pseudonym);
  for (const char* sql : {"UPDATE participant SET study_group = '', arm = '' WHERE id = ?",
                          "DELETE FROM cohort_participant WHERE participant = ?",
                          "DELETE FROM consent WHERE participant = ? AND purpose IN ('research', 'study')"}) {
    SQLite::Statement change(db, sql);
    change.bind(1, id);
    change.exec();
  }
  SQLite::Statement put(db, "INSERT INTO research_withdrawal VALUES (?, ?) ON CONFLICT DO NOTHING");
  SQLite::bind(put, id, nowUtc());
  put.exec();
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

/// Deleted content must not remain in free pages or in the log.
void rebuild(SQLite::Database& db, const std::string& path) {
  const auto checkpoint = [&] {
    SQLite::Statement run(db, "PRAGMA wal_checkpoint(TRUNCATE)");
    run.executeStep();
    if (run.getColumn(0).getInt() != 0) {
      throw Error(ErrorKind::failure, Where{path}, "another program reads it, so that its log cannot be emptied",
                  {Remedy::emptyLog});
    }
  };
  checkpoint();
  db.exec("VACUUM");
  checkpoint();
}

/// Within a transaction: every row that hangs on the withdrawal, and the words of audit rows that name it.
void removeRows(SQLite::Database& db, const Withdrawal& w, const std::string& id) {
  db.exec("PRAGMA defer_foreign_keys = ON");
  leaveTombstone(db, id, w);
  SQLite::Statement remove(db, "DELETE FROM attempt WHERE uuid = ?");
  for (const std::string& uuid : w.attempts) {
    remove.reset();
    remove.bind(1, uuid);
    remove.exec();
  }
  if (w.scope == WithdrawalScope::all) {
    SQLite::Statement who(db, "DELETE FROM participant WHERE pseudonym = ?");
    who.bind(1, w.pseudonym);
    who.exec();
  } else {
    leaveResearch(db, w.pseudonym);
  }
  deleteOrphans(db);
  for (const std::string& uuid : w.attempts) deleteByUuid(db, uuid);
  deleteOrphans(db);
  for (const ExportRow& row : w.exports) {
    SQLite::Statement empty(db,
                            "DELETE FROM export WHERE at_utc = ? AND kind = ? AND target = ? AND id NOT IN "
                            "(SELECT export FROM export_attempt)");
    SQLite::bind(empty, row.utc, row.kind, row.target);
    empty.exec();
  }
  std::vector<std::string> words = w.attempts;
  if (w.scope == WithdrawalScope::all) words.push_back(w.pseudonym);
  silenceAudit(db, words, "withdrawn " + id);
}

std::vector<std::string> columnsNaming(SQLite::Database& db, const std::vector<std::string>& words) {
  std::vector<std::string> places;
  for (const TableFacts& table : readTables(db)) {
    for (const ColumnFacts& column : table.columns) {
      if (column.type != "TEXT") continue;
      SQLite::Statement read(
          db, fmt::format("SELECT DISTINCT {} FROM {}", quotedName(column.name), quotedName(table.name)));
      bool found = false;
      while (!found && read.executeStep()) {
        const std::string held = text(read.getColumn(0));
        found = std::any_of(words.begin(), words.end(), [&](const std::string& w) { return namesWord(held, w); });
      }
      if (found) places.push_back(table.name + "." + column.name);
    }
  }
  return places;
}

std::unique_ptr<SQLite::Database> openForDeletion(const std::string& path) {
  auto db = openCohort(path, CohortDatabase::Access::write, withdrawalPatience);
  db->exec("PRAGMA secure_delete = ON");
  return db;
}

}  // namespace

bool namesWord(const std::string& where, const std::string& word) {
  if (word.empty()) return false;
  for (std::size_t at = where.find(word); at != std::string::npos; at = where.find(word, at + 1)) {
    const bool begins = at == 0 || !wordLetter(where[at - 1]) || !wordLetter(word.front());
    const std::size_t end = at + word.size();
    const bool ends = end == where.size() || !wordLetter(where[end]) || !wordLetter(word.back());
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
  const std::string id = recorder::newUuid();
  guarded(path, [&] {
    const auto handle = openForDeletion(path);
    SQLite::Database& db = *handle;
    {
      SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
      removeRows(db, w, id);
      audit(db, "participant-withdraw", w.scope == WithdrawalScope::all ? "withdrawn " + id : w.pseudonym,
            fmt::format("scope {}, {} attempts", w.scope == WithdrawalScope::all ? "all" : "research",
                        w.attempts.size()));
      transaction.commit();
    }
    rebuild(db, path);
    removeBackups(path);
  });
  return id;
}

void scrub(const std::string& path) {
  guarded(path, [&] {
    const auto db = openForDeletion(path);
    rebuild(*db, path);
    removeBackups(path);
  });
}

std::vector<std::string> placesNaming(const std::string& path, const std::vector<std::string>& words) {
  return guarded(path, [&] {
    const auto handle = openCohort(path, CohortDatabase::Access::read, withdrawalPatience);
    return columnsNaming(*handle, words);
  });
}

std::vector<std::string> placesLeft(const std::string& path, const Withdrawal& w,
                                    const std::vector<std::string>& words) {
  return guarded(path, [&] {
    SQLite::Database copy(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    {
      const auto from = openCohort(path, CohortDatabase::Access::read, withdrawalPatience);
      SQLite::Backup(copy, *from).executeStep(-1);
    }
    copy.exec("PRAGMA foreign_keys = ON");
    SQLite::Transaction transaction(copy);
    if (w.known) removeRows(copy, w, recorder::newUuid());
    return columnsNaming(copy, words);
  });
}

bool wasWithdrawn(const std::string& path, const std::string& uuid) {
  return guarded(path, [&] {
    const auto db = openCohort(path, CohortDatabase::Access::read, withdrawalPatience);
    return isWithdrawn(*db, uuid);
  });
}

namespace {

using namespace tables;

constexpr auto planPatience = std::chrono::seconds(10);

/// Attempts that branch from one of these, from those, and so on, behind them.
void addBranches(SQLite::Database& db, std::vector<std::string>& uuids) {
  std::set<std::string> known(uuids.begin(), uuids.end());
  SQLite::Statement find(db, "SELECT uuid FROM attempt WHERE parent_uuid = ? ORDER BY uuid");
  for (std::size_t i = 0; i < uuids.size(); ++i) {
    find.reset();
    find.bind(1, uuids[i]);
    while (find.executeStep()) {
      std::string uuid = find.getColumn(0).getString();
      if (known.insert(uuid).second) uuids.push_back(std::move(uuid));
    }
  }
}

}  // namespace

void recordExport(const std::string& path, const std::string& kind, const std::string& target,
                  const std::vector<std::string>& attempts) {
  guarded(path, [&] {
    const auto handle = openCohort(path, CohortDatabase::Access::write, planPatience);
    SQLite::Database& db = *handle;
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    std::error_code ignored;
    const std::string place = std::filesystem::absolute(target, ignored).lexically_normal().string();
    SQLite::Statement put(db, "INSERT INTO export (at_utc, kind, target) VALUES (?, ?, ?)");
    SQLite::bind(put, nowUtc(), kind, place);
    put.exec();
    const std::int64_t id = db.getLastInsertRowid();
    SQLite::Statement link(db, "INSERT INTO export_attempt VALUES (?, ?) ON CONFLICT DO NOTHING");
    for (const std::string& uuid : attempts) {
      const std::int64_t attempt = attemptId(db, uuid);
      if (attempt < 0) throw Error(ErrorKind::refused, Where{path}, fmt::format("no attempt {}", uuid));
      link.reset();
      SQLite::bind(link, id, attempt);
      link.exec();
    }
    transaction.commit();
  });
}

Withdrawal planWithdrawal(const std::string& path, const std::string& pseudonym, WithdrawalScope scope) {
  return guarded(path, [&] {
    const auto handle = openCohort(path, CohortDatabase::Access::write, planPatience);
    SQLite::Database& db = *handle;
    Withdrawal w;
    w.pseudonym = pseudonym;
    w.scope = scope;
    const std::int64_t id = participantId(db, pseudonym);
    w.known = id >= 0;
    if (!w.known) return w;
    SQLite::Statement own(db,
                          "SELECT uuid FROM attempt WHERE participant = ? AND (? OR purpose <> 'training') "
                          "ORDER BY uuid");
    SQLite::bind(own, id, scope == WithdrawalScope::all ? 1 : 0);
    while (own.executeStep()) w.attempts.push_back(own.getColumn(0).getString());
    addBranches(db, w.attempts);
    std::set<ExportRow, bool (*)(const ExportRow&, const ExportRow&)> exports(
        [](const ExportRow& a, const ExportRow& b) {
          return std::tie(a.utc, a.kind, a.target) < std::tie(b.utc, b.kind, b.target);
        });
    SQLite::Statement whose(db, "SELECT coalesce(participant, -1) FROM attempt WHERE uuid = ?");
    SQLite::Statement held(db,
                           "SELECT e.at_utc, e.kind, e.target FROM export e JOIN export_attempt x ON x.export = e.id "
                           "JOIN attempt a ON a.id = x.attempt WHERE a.uuid = ?");
    for (const std::string& uuid : w.attempts) {
      whose.reset();
      whose.bind(1, uuid);
      if (whose.executeStep() && whose.getColumn(0).getInt64() != id && whose.getColumn(0).getInt64() >= 0)
        w.branchesOfOthers.push_back(uuid);
      held.reset();
      held.bind(1, uuid);
      while (held.executeStep())
        exports.insert({text(held.getColumn(0)), text(held.getColumn(1)), text(held.getColumn(2))});
    }
    w.exports.assign(exports.begin(), exports.end());
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
  const std::array<std::byte, 32> digest = withdrawalDigest(uuid);
  SQLite::Statement find(db, "SELECT 1 FROM tombstone_attempt WHERE digest = ?");
  find.bind(1, digest.data(), static_cast<int>(digest.size()));
  return find.executeStep();
}

}  // namespace calot::analytics::tables
