// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/cohort/tables.h"

#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>
#include <filesystem>
#include <system_error>
#include <thread>

#include "analytics/cohort/embedded.h"
#include "recorder/base/dates.h"

namespace calot::analytics {

std::string printable(std::string words) {
  for (char& c : words) {
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7F) c = '?';
  }
  return words;
}

Error databaseError(int sqliteCode, const std::string& words, const std::string& path) {
  const std::string message = printable(words);
  const auto failure = [&](const std::string& fault) { return Error(ErrorKind::failure, Where{path}, fault); };
  const auto damaged = [&](const std::string& fault) { return Error(ErrorKind::damaged, Where{path}, fault); };
  switch (sqliteCode & 0xFF) {
    case SQLITE_NOTADB:
      return damaged("not a cohort database (not an SQLite file)");
    case SQLITE_CORRUPT:
      return damaged(
          fmt::format("damaged database ({}); restore a copy, or assess the recordings into a new one", message));
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return failure("in use by another program; try again when it has finished");
    case SQLITE_READONLY:
      return failure("can't be written; check the permissions of the file and its folder");
    case SQLITE_FULL:
      return failure("disk full; nothing was changed, free space and run again");
    case SQLITE_IOERR:
      return failure(
          fmt::format("reading or writing failed ({}); nothing was changed, check the disk and run again", message));
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
    case SQLITE_AUTH:
      return failure("can't be opened; check that the folder exists and the permissions");
    case SQLITE_ERROR:
      return damaged(fmt::format("its tables are not those of a cohort database ({})", message));
    default:
      return failure(fmt::format("database failure ({})", message));
  }
}

namespace {

using CohortAccess = CohortDatabase::Access;

/// Refuses files that SQLite would silently treat as an empty database.
void checkFile(const std::string& path, CohortAccess access) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  const auto refuse = [&](const char* fault) { throw Error(ErrorKind::damaged, Where{path}, fault); };
  if (!std::filesystem::exists(status)) {
    if (access != CohortAccess::create) refuse("no such cohort database");
    return;
  }
  if (!std::filesystem::is_regular_file(status)) refuse("not a cohort database (not a file)");
  if (access != CohortAccess::create && std::filesystem::file_size(path, error) == 0)
    refuse("not a cohort database (empty file)");
}

int pragma(SQLite::Database& db, const char* name) { return db.execAndGet(fmt::format("PRAGMA {}", name)).getInt(); }

/// Path as an SQLite URI.
std::string uriOf(const std::string& path) {
  std::string uri = "file:";
  for (const char c : path) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/' ||
                       c == '.' || c == '_' || c == '-';
    uri += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
  }
  return uri + "?immutable=1";
}

std::unique_ptr<SQLite::Database> connect(const std::string& path, CohortAccess access, int patience) {
  if (access != CohortAccess::read) {
    const int create = access == CohortAccess::create ? SQLite::OPEN_CREATE : 0;
    return std::make_unique<SQLite::Database>(path, SQLite::OPEN_READWRITE | create, patience);
  }
  auto db = std::make_unique<SQLite::Database>(path, SQLite::OPEN_READONLY, patience);
  try {
    pragma(*db, "schema_version");
  } catch (const SQLite::Exception& error) {
    // A reader of a WAL database creates an index file beside it. If it may not (read-only medium) and nobody writes,
    // the file alone is the whole database.
    const int code = error.getErrorCode() & 0xFF;
    if (code == SQLITE_READONLY && std::filesystem::exists(path + "-journal")) {
      // A writer was killed before the database had a log: only a connection that may write takes back what it began.
      SQLite::Database back(path, SQLite::OPEN_READWRITE, patience);
      pragma(back, "schema_version");
      db = std::make_unique<SQLite::Database>(path, SQLite::OPEN_READONLY, patience);
      pragma(*db, "schema_version");
      return db;
    }
    if ((code != SQLITE_CANTOPEN && code != SQLITE_READONLY) || std::filesystem::exists(path + "-wal")) throw;
    db = std::make_unique<SQLite::Database>(uriOf(path), SQLite::OPEN_READONLY | SQLite::OPEN_URI, patience);
    pragma(*db, "schema_version");
  }
  return db;
}

/// The one pragma that SQLite refuses at once, without waiting, while another process does the same.
void setWriteAheadLog(SQLite::Database& db, std::chrono::milliseconds patience) {
  const auto until = std::chrono::steady_clock::now() + patience;
  while (true) {
    try {
      db.exec("PRAGMA journal_mode = WAL");
      return;
    } catch (const SQLite::Exception& error) {
      if ((error.getErrorCode() & 0xFF) != SQLITE_BUSY || std::chrono::steady_clock::now() >= until) throw;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
}

/// Schema version of the file; 0 for a new one. @pre within a transaction: another process may be making the database,
/// and half of before and half of after would look like another program's file. @throws Error for what is not ours or
/// is newer.
int schemaOf(SQLite::Database& db, const std::string& path) {
  const int application = pragma(db, "application_id");
  const int version = pragma(db, "user_version");
  const bool empty = db.execAndGet("SELECT count(*) FROM sqlite_master").getInt() == 0;
  if (application == 0 && version == 0 && empty) return 0;
  if (application != cohortApplicationId) {
    throw Error(ErrorKind::damaged, Where{path}, "not a cohort database (another program's SQLite file)");
  }
  const int known = static_cast<int>(cohortMigrations().size());
  if (version > known) {
    throw Error(ErrorKind::undecided, Where{path},
                fmt::format("cohort schema {} is newer than this program's {}; use a newer Calot", version, known));
  }
  if (version < 1)
    throw Error(ErrorKind::damaged, Where{path}, fmt::format("cohort schema {} does not exist", version));
  return version;
}

/// Backs the database up beside it, since migrations cannot be reversed. An existing backup is kept.
void backUp(SQLite::Database& db, const std::string& path, int version) {
  namespace fs = std::filesystem;
  const std::string name = fmt::format("{}{}{}", path, backupMark, version);
  std::string kept = name + ".bak";
  for (int n = 2; fs::exists(kept); ++n) kept = fmt::format("{}-{}.bak", name, n);
  const std::string fresh = fmt::format("{}.{}.part", kept, ::getpid());
  std::error_code ignored;
  fs::remove(fresh, ignored);
  const auto failed = [&](const std::string& why, const char* advice) {
    fs::remove(fresh, ignored);
    return Error(ErrorKind::failure, Where{path},
                 fmt::format("cannot be backed up before its schema is brought up to date ({}); nothing was changed{}",
                             why, advice));
  };
  try {
    execute(db, "VACUUM INTO ?", {fresh});
    SQLite::Database copy(fresh, SQLite::OPEN_READONLY);
    if (pragma(copy, "user_version") != version) {  // another process has already migrated it
      fs::remove(fresh);
      return;
    }
    fs::permissions(fresh, fs::status(path).permissions());
    fs::rename(fresh, kept);
  } catch (const SQLite::Exception& error) {
    throw failed(error.what(), ", free space beside it and run again");
  } catch (const fs::filesystem_error& error) {
    throw failed(error.code().message(), "");
  }
}

void migrate(SQLite::Database& db, const std::string& path) {
  // Checked again inside the transaction: another process may have migrated it meanwhile.
  SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
  const std::vector<Migration>& migrations = cohortMigrations();
  for (auto version = static_cast<std::size_t>(schemaOf(db, path)); version < migrations.size(); ++version) {
    db.exec(migrations[version].sql);
    db.exec(fmt::format("PRAGMA user_version = {}", version + 1));
  }
  db.exec(fmt::format("PRAGMA application_id = {}", cohortApplicationId));
  transaction.commit();
}

}  // namespace

std::unique_ptr<SQLite::Database> openCohort(const std::string& path, CohortAccess access,
                                             std::chrono::milliseconds patience) {
  return guarded(path, [&] {
    checkFile(path, access);
    auto db = connect(path, access, static_cast<int>(patience.count()));
    db->exec("PRAGMA foreign_keys = ON");
    db->exec("PRAGMA trusted_schema = OFF");
    const int version = [&] {
      const SQLite::Transaction reading(*db);
      return schemaOf(*db, path);
    }();
    const int known = static_cast<int>(cohortMigrations().size());
    if (access == CohortAccess::read) {
      if (version == 0) throw Error(ErrorKind::damaged, Where{path}, "not a cohort database (no tables)");
      if (version < known) {
        throw Error(ErrorKind::failure, Where{path},
                    fmt::format("cohort schema {} must be brought to {} first", version, known),
                    {Remedy::upgradeCohort});
      }
      return db;
    }
    if (version == 0 && access != CohortAccess::create) {
      throw Error(ErrorKind::damaged, Where{path}, "not a cohort database (no tables)");
    }
    if (sqlite3_db_readonly(db->getHandle(), "main") == 1) throw databaseError(SQLITE_READONLY, "", path);
    setWriteAheadLog(*db, patience);
    db->exec("PRAGMA synchronous = FULL");
    if (version >= 1 && version < known) backUp(*db, path, version);
    if (version < known) migrate(*db, path);
    return db;
  });
}

std::string nowUtc() { return recorder::presentDate(); }

}  // namespace calot::analytics
