// SPDX-License-Identifier: GPL-3.0-or-later
// Schema 6 builds the table of values anew: what was in it stays.
#include <gtest/gtest.h>

#include <SQLiteCpp/SQLiteCpp.h>

#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/embedded.h"
#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

TEST(CoverageMigration, valuesWithoutCoverageKeepWhatTheyAre) {
  const support::Folder folder;
  const std::string path = folder.file("old.db");
  {
    SQLite::Database raw(path, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    for (std::size_t i = 0; i < 5; ++i) raw.exec(cohortMigrations()[i].sql);
    raw.exec("PRAGMA user_version = 5; PRAGMA application_id = 1130458223");
    raw.exec(
        "INSERT INTO attempt (id, uuid, scene, scene_major, scene_minor, operator_kind, mode, outcome, start_utc, "
        "seed, "
        "simulation_version, comparability_key, synthetic, imported_utc) VALUES (1, "
        "'00000000-0000-4000-8000-000000000007', 'knots', 1, 0, 1, 1, 1, '', '1', 0, 'knots/0', 0, "
        "'2026-01-01T00:00:00Z')");
    raw.exec(
        "INSERT INTO checkpoint_value VALUES (1, 0, 'path-length', 'left', 2, 0, 0.5, '', 'seen', 'm', 2, 'f'), "
        "(1, 1, 'path-length', 'right', 2, 1, NULL, 'no instrument in this hand', '', 'm', 2, 'f')");
  }
  const CohortDatabase database(path, CohortDatabase::Access::write);
  const std::vector<AttemptValue> values = database.allValues();
  ASSERT_EQ(values.size(), 2U);
  EXPECT_EQ(values[0].value.value, 0.5);
  EXPECT_EQ(values[0].value.note, "seen");
  EXPECT_EQ(values[1].value.availability, Availability::notApplicable);
  expectNames(values[1].value.reason, {"hand"});
  for (const AttemptValue& v : values) EXPECT_FALSE(v.value.coverage || v.value.rate || v.value.noise) << "not known";
}

}  // namespace
}  // namespace calot::analytics
