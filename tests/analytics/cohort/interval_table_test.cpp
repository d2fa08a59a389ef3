// SPDX-License-Identifier: GPL-3.0-or-later
// Intervals of the simulation beside the values that they are of.
#include <gtest/gtest.h>

#include <SQLiteCpp/SQLiteCpp.h>

#include <cmath>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/merge.h"
#include "recorder/base/errors.h"
#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/support/fault.h"

namespace calot::analytics {
namespace {

using support::attemptOf;
using support::Folder;
using support::uuidOf;
using support::valuesOf;

/// An interval is of one value: it is there while the value is, and gone with it.
TEST(Intervals, areOfPresentValues) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), CohortDatabase::Access::create);
  database.storeAttempt(attemptOf(1, "skilled"), valuesOf(10.0, 0.3));
  const std::vector<ValueInterval> made{
      {"elapsed-time", "", 1, 10.0, 0.1, -0.2, 0.3, 9.0, 11.0, "", {9.5, 10.25, 0.1 + 0.2}},
      {"path-length",
       "left",
       findCheckpoint("path-length")->version,
       0.3,
       0.0,
       0.0,
       0.0,
       {},
       {},
       "it has no value with a finer mesh: nothing was done",
       {}}};
  database.storeIntervals(uuidOf(1), made);
  EXPECT_EQ(database.intervals(uuidOf(1)), made);
  const auto audited = [&] {
    const SQLite::Database raw(database.path(), SQLite::OPEN_READONLY);
    SQLite::Statement rows(raw, "SELECT count(*) FROM audit WHERE action = 'attempt-intervals'");
    rows.executeStep();
    return rows.getColumn(0).getInt();
  };
  EXPECT_EQ(audited(), 1);
  database.storeIntervals(uuidOf(1), made);
  EXPECT_EQ(audited(), 1) << "again changes nothing";
  std::size_t with = 0;
  for (const AttemptValue& v : database.allValues()) {
    with += v.interval ? 1 : 0;
    if (v.interval && v.value.name == "elapsed-time") {
      EXPECT_EQ(*v.interval, made[0]);
    }
  }
  EXPECT_EQ(with, 2U);
  database.storeValues(uuidOf(1), valuesOf(std::nextafter(10.0, 11.0), 0.3));
  ASSERT_EQ(database.intervals(uuidOf(1)).size(), 1U) << "of the changed value there is none";
  EXPECT_EQ(database.intervals(uuidOf(1))[0].name, "path-length");
  expectFault(ErrorKind::refused, "", {uuidOf(9)}, [&] { database.storeIntervals(uuidOf(9), made); });
}

/// Two sets of intervals are no conflict: those that are there stay, and fill what is empty.
TEST(Intervals, mergeWithTheirAttempts) {
  const Folder folder;
  const std::string a = folder.file("a.db"), b = folder.file("b.db");
  const auto intervalOf = [](double lower) {
    return std::vector<ValueInterval>{{"elapsed-time", "", 1, 10.0, 0.1, -0.2, 0.3, lower, 11.0, "", {9.5, 10.25}}};
  };
  {
    CohortDatabase first(a, CohortDatabase::Access::create), second(b, CohortDatabase::Access::create);
    for (const unsigned n : {1U, 2U}) {
      first.storeAttempt(attemptOf(n, "skilled"), valuesOf(10.0, 0.3));
      second.storeAttempt(attemptOf(n, "skilled"), valuesOf(10.0, 0.3));
    }
    second.storeAttempt(attemptOf(3, "skilled"), valuesOf(10.0, 0.3));
    first.storeIntervals(uuidOf(1), intervalOf(9.0));
    for (const unsigned n : {1U, 2U, 3U}) second.storeIntervals(uuidOf(n), intervalOf(8.0));
  }
  const CohortMerge merge = mergeCohorts(a, b);
  EXPECT_TRUE(merge.conflicts.empty());
  EXPECT_FALSE(mergeCohorts(a, b).changed());
  const CohortDatabase merged(a, CohortDatabase::Access::read);
  EXPECT_EQ(merged.intervals(uuidOf(1)), intervalOf(9.0));
  EXPECT_EQ(merged.intervals(uuidOf(2)), intervalOf(8.0));
  EXPECT_EQ(merged.intervals(uuidOf(3)), intervalOf(8.0));
}

}  // namespace
}  // namespace calot::analytics
