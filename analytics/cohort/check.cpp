// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/cohort/check.h"

#include <fmt/format.h>

#include "analytics/cohort/connection.h"
#include "analytics/cohort/embedded.h"
#include "analytics/cohort/row_statements.h"

namespace calot::analytics {

CohortCheck checkCohort(const std::string& path) {
  return guarded(path, [&] {
    const auto handle = openCohort(path, CohortDatabase::Access::read, std::chrono::seconds(10));
    SQLite::Database& db = *handle;
    CohortCheck result;
    result.schema = db.execAndGet("PRAGMA user_version").getInt();
    SQLite::Statement integrity(db, "PRAGMA integrity_check");
    while (integrity.executeStep()) {
      const std::string line = integrity.getColumn(0).getString();
      if (line != "ok") result.faults.push_back(printable(line));
    }
    if (!result.faults.empty()) return result;  // what else would be said of it means nothing
    if (static_cast<std::size_t>(result.schema) == cohortMigrations().size()) result.faults = tables::schemaFaults(db);

    SQLite::Statement foreign(db, "SELECT \"table\", \"parent\", count(*) FROM pragma_foreign_key_check GROUP BY 1, 2");
    while (foreign.executeStep()) {
      result.faults.push_back(fmt::format("{} rows of {} refer to no row of {}", foreign.getColumn(2).getInt64(),
                                          foreign.getColumn(0).getString(), foreign.getColumn(1).getString()));
    }
    SQLite::Statement bare(db, "SELECT uuid FROM attempt WHERE id NOT IN (SELECT attempt FROM recording)");
    while (bare.executeStep())
      result.faults.push_back(fmt::format("attempt {} has no recording", bare.getColumn(0).getString()));
    SQLite::Statement signature(db,
                                "SELECT a.uuid FROM recording_signature s JOIN recording r USING (attempt) "
                                "JOIN attempt a ON a.id = s.attempt WHERE s.chain_head <> r.chain_head");
    while (signature.executeStep()) {
      result.faults.push_back(
          fmt::format("attempt {}: its signature is of another content", signature.getColumn(0).getString()));
    }
    const auto count = [&](const char* table) {
      return static_cast<std::uint64_t>(db.execAndGet(fmt::format("SELECT count(*) FROM {}", table)).getInt64());
    };
    result.participants = count("participant");
    result.attempts = count("attempt");
    result.values = count("checkpoint_value");
    return result;
  });
}

void refuseUnsound(const std::string& path) {
  const CohortCheck check = checkCohort(path);
  if (check.faults.empty()) return;
  throw Error(ErrorKind::damaged, Where{path},
              fmt::format("{} faults, the first: {}; restore a copy, or assess the recordings into a new one",
                          check.faults.size(), check.faults.front()));
}

}  // namespace calot::analytics
