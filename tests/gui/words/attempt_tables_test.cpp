// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <sstream>

#include "gui/words/attempt_summary.h"
#include "tests/analytics/cohort/support/cohort_support.h"

namespace calot::analytics {
namespace {

using Access = CohortDatabase::Access;
using support::attemptOf;
using support::Folder;
using support::valuesOf;

/// Columns follow from the declarations: one for the attempt, each hand, each organ, where any attempt has a value.
TEST(AttemptTables, closingTableHasTheColumnsThatCheckpointsAskFor) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  std::vector<CheckpointValue> values = valuesOf(1.0, 0.5);
  for (const char* organ : {"spleen", "gallbladder"})
    values.push_back(makeValue(*findCheckpoint("organ-burned"), organ, Origin::resimulated, 0.25));
  values.push_back(makeValue(*findCheckpoint("attempt-duration"), "", Origin::resimulated, 2.0));
  values.push_back(makeValue(*findCheckpoint("speed-mean"), "left", Origin::samples, 0.01));
  database.storeAttempt(attemptOf(1, ""), values);
  std::ostringstream table;
  gui::printAttempts(database, table);
  const std::string head = table.str().substr(0, table.str().find('\n'));
  std::size_t last = 0;
  for (const char* title : {"elapsed s", "path L mm", "spleen burned %", "gallbladder burned %", "duration s"}) {
    const std::size_t at = head.find(title);
    ASSERT_NE(at, std::string::npos) << title << "\n" << head;
    EXPECT_GT(at, last) << "in the registry's order, organs in that of their values: " << head;
    last = at;
  }
  EXPECT_EQ(head.find("path R"), std::string::npos) << "no attempt has it";
  EXPECT_EQ(head.find("speed"), std::string::npos) << "does not ask for a column";
  EXPECT_NE(table.str().find("25.0"), std::string::npos) << "in display units\n" << table.str();
}

TEST(AttemptTables, namesVerdictAndMarksPerformers) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  database.storeAttempt(attemptOf(3, "skilled"), valuesOf(1.0, 0.5));
  std::ostringstream table;
  gui::printAttempts(database, table);
  EXPECT_NE(table.str().find("SYNTHETIC"), std::string::npos);
  EXPECT_NE(table.str().find("verified"), std::string::npos);
  EXPECT_NE(table.str().find("500.0"), std::string::npos) << "left path in mm\n" << table.str();
}

}  // namespace
}  // namespace calot::analytics
