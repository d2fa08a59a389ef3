// SPDX-License-Identifier: GPL-3.0-or-later
// Opening a cohort database: which file it is, its schema, migrations. CohortDatabase builds on it.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>
#include <chrono>
#include <memory>
#include <string>
#include <type_traits>

#include "analytics/cohort/cohort_database.h"
#include "recorder/base/errors.h"

namespace calot::analytics {

/// An SQLite message, which may quote content of a damaged file, with '?' for non-ASCII characters.
std::string printable(std::string words);

/// One line for the user that explains an SQLite result code and names the file.
Error databaseError(int sqliteCode, const std::string& message, const std::string& path);

/// "Calo": application id of a cohort database in SQLite's header.
inline constexpr int cohortApplicationId = 0x43616C6F;

/// Between a database's name and the number of the schema that a migration's backup of it has.
inline constexpr const char* backupMark = ".schema-";

/// Opens, checks and (unless read-only) migrates. What an older schema held is kept beside it as
/// PATH.schema-N.bak, N its number. @throws Error as CohortDatabase says.
std::unique_ptr<SQLite::Database> openCohort(const std::string& path, CohortDatabase::Access access,
                                             std::chrono::milliseconds patience);

/// Runs `work` and turns SQLite's exceptions into calot::Error.
template <class Work>
auto guarded(const std::string& path, Work&& work) -> decltype(work()) {
  try {
    return work();
  } catch (const SQLite::Exception& error) {
    throw databaseError(error.getErrorCode(), error.what(), path);
  }
}

/// An open cohort database. Errors of SQLite within `work` become calot::Error.
struct CohortConnection {
  explicit CohortConnection(const std::string& file, CohortDatabase::Access access,
                            std::chrono::milliseconds patience = std::chrono::seconds(10))
      : path(file), db(openCohort(file, access, patience)) {}

  /// work(database).
  template <class Work>
  auto read(Work work) const {
    return guarded(path, [&] { return work(*db); });
  }
  /// work(database) in one transaction, which an exception takes back.
  template <class Work>
  auto change(Work work) {
    return read([&](SQLite::Database& database) {
      SQLite::Transaction transaction(database, SQLite::TransactionBehavior::IMMEDIATE);
      if constexpr (std::is_void_v<decltype(work(database))>) {
        work(database);
        transaction.commit();
      } else {
        auto result = work(database);
        transaction.commit();
        return result;
      }
    });
  }

  std::string path;
  std::unique_ptr<SQLite::Database> db;
};

/// Now, ISO 8601 UTC in seconds: "2014-05-17T09:30:00Z".
std::string nowUtc();

}  // namespace calot::analytics
