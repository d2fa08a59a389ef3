// SPDX-License-Identifier: GPL-3.0-or-later
// Opening a cohort database: which file it is, its schema, migrations. CohortDatabase builds on it.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>
#include <chrono>
#include <memory>
#include <string>

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

/// Now, ISO 8601 UTC in seconds: "2014-05-17T09:30:00Z".
std::string nowUtc();

}  // namespace calot::analytics
