// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/cohort/tables.h"

#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>
#include <filesystem>
#include <system_error>
#include <thread>

#include "analytics/cohort/embedded.h"
#include "analytics/cohort/page_sums.h"
#include "recorder/base/dates.h"

namespace calot::analytics {

std::string printable(std::string words) {
  for (char& c : words) {
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7F) c = '?';
  }
  return words;
}

bool isBusy(const SQLite::Exception& error) { return (error.getErrorCode() & 0xFF) == SQLITE_BUSY; }

Error databaseError(int sqliteCode, const std::string& words, const std::string& path) {
  const std::optional<Error> known = layersFault();
  if (known && ((sqliteCode & 0xFF) == SQLITE_IOERR || (sqliteCode & 0xFF) == SQLITE_BUSY)) return *known;
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
    case SQLITE_NOMEM:
      return failure("too little memory; nothing was changed, end other programs and run again");
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

/// schemas/cohort/0014_page_sums.sql
constexpr int firstSummedSchema = 14;

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

std::unique_ptr<SQLite::Database> connect(const std::string& path, CohortAccess access, int patience) {
  const auto open = [&](int flags) {
    auto db = std::make_unique<SQLite::Database>(path, flags, patience, pageSumLayer());
    pragma(*db, "schema_version");
    return db;
  };
  if (access == CohortAccess::create) return open(SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  if (access == CohortAccess::write) return open(SQLite::OPEN_READWRITE);
  try {
    return open(SQLite::OPEN_READONLY);
  } catch (const SQLite::Exception& error) {
    if ((error.getErrorCode() & 0xFF) != SQLITE_READONLY || !std::filesystem::exists(path + "-journal")) throw;
  }
  // A writer was killed: only a connection that may write takes back what it began.
  open(SQLite::OPEN_READWRITE);
  return open(SQLite::OPEN_READONLY);
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
  const std::string fresh = fmt::format("{}.{}.part", kept, ::gettid());
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

std::unique_ptr<SQLite::Database> openOnce(const std::string& path, CohortAccess access, int patience) {
  checkFile(path, access);
  auto db = connect(path, access, patience);
  db->exec("PRAGMA foreign_keys = ON; PRAGMA trusted_schema = OFF");
  const int version = [&] {
    const SQLite::Transaction reading(*db);
    return schemaOf(*db, path);
  }();
  const int known = static_cast<int>(cohortMigrations().size());
  const bool sums = hasPageSums(db->getHandle());
  if (version >= firstSummedSchema && !sums) {
    throw Error(ErrorKind::damaged, Where{path},
                "its pages have no checksums: it is damaged, or another program has rebuilt it; restore a copy, or "
                "assess the recordings into a new one");
  }
  if (version == 0 && access != CohortAccess::create)
    throw Error(ErrorKind::damaged, Where{path}, "not a cohort database (no tables)");
  if (access == CohortAccess::read) {
    if (version < known) {
      throw Error(ErrorKind::failure, Where{path},
                  fmt::format("cohort schema {} must be brought to {} first", version, known), {Remedy::upgradeCohort});
    }
    return db;
  }
  if (sqlite3_db_readonly(db->getHandle(), "main") == 1) throw databaseError(SQLITE_READONLY, "", path);
  db->exec("PRAGMA synchronous = FULL");
  db->exec("PRAGMA journal_mode = DELETE");  // earlier schemas had a log, without which a copy was not whole
  if (version >= 1 && version < known) backUp(*db, path, version);
  if (!sums) {
    askForPageSums(db->getHandle());
    if (version >= 1) db->exec("PRAGMA cache_spill = OFF; VACUUM; PRAGMA cache_spill = ON");
  }
  if (version < known) migrate(*db, path);
  return db;
}

}  // namespace

std::unique_ptr<SQLite::Database> openCohort(const std::string& path, CohortAccess access,
                                             std::chrono::milliseconds patience) {
  const auto until = std::chrono::steady_clock::now() + patience;
  return guarded(path, [&] {
    while (true) {
      try {
        return openOnce(path, access, static_cast<int>(patience.count()));
      } catch (const SQLite::Exception& error) {
        // SQLite does not wait for the last other connection to close, before which a database cannot leave its log.
        if (!isBusy(error) || std::chrono::steady_clock::now() >= until) throw;
        std::this_thread::sleep_for(std::chrono::milliseconds(1 + ::getpid() % 17));
      }
    }
  });
}

std::string nowUtc() { return recorder::presentDate(); }

}  // namespace calot::analytics
