// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/cohort/check.h"

#include <fmt/format.h>

#include "analytics/cohort/connection.h"
#include "analytics/cohort/embedded.h"
#include "analytics/cohort/tables.h"

namespace calot::analytics {

CohortCheck checkCohort(const std::string& path) {
  return CohortConnection(path, CohortDatabase::Access::read).read([](SQLite::Database& db) {
    CohortCheck result;
    result.schema = db.execAndGet("PRAGMA user_version").getInt();
    for (const std::string& line : firstTexts(db, "PRAGMA integrity_check")) {
      if (line != "ok") result.faults.push_back(printable(line));
    }
    if (!result.faults.empty()) return result;  // what else would be said of it means nothing
    if (static_cast<std::size_t>(result.schema) == cohortMigrations().size()) result.faults = tables::schemaFaults(db);
    for (const char* fault :
         {"SELECT count(*) || ' rows of ' || \"table\" || ' refer to no row of ' || \"parent\" FROM "
          "pragma_foreign_key_check GROUP BY \"table\", \"parent\"",
          "SELECT 'attempt ' || uuid || ' has no recording' FROM attempt WHERE id NOT IN (SELECT attempt FROM "
          "recording)",
          "SELECT 'attempt ' || a.uuid || ': its signature is of another content' FROM recording_signature s JOIN "
          "recording r USING (attempt) JOIN attempt a ON a.id = s.attempt WHERE s.chain_head <> r.chain_head"}) {
      for (std::string& line : firstTexts(db, fault)) result.faults.push_back(std::move(line));
    }
    const auto count = [&](const char* table) {
      return static_cast<std::uint64_t>(firstNumber(db, fmt::format("SELECT count(*) FROM {}", table)));
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
