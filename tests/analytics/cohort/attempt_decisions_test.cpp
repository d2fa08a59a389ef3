// SPDX-License-Identifier: GPL-3.0-or-later
// Attempts in lists: their fields, and what people decide about them (exclusions and tags).
#include <gtest/gtest.h>

#include <SQLiteCpp/SQLiteCpp.h>

#include <map>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/tables.h"
#include "recorder/base/errors.h"
#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/support/fault.h"

namespace calot::analytics {
namespace {

using Access = CohortDatabase::Access;
using support::attemptOf;
using support::Folder;
using support::uuidOf;
using support::valuesOf;

TEST(AttemptDecisions, exclusionsAreKeptWithReasonAndAuthorAndAudited) {
  const Folder folder;
  const std::string path = folder.file("c.db");
  CohortDatabase database(path, Access::create);
  database.storeAttempt(attemptOf(1, "skilled"), {});
  database.excludeAttempts({uuidOf(1)}, "fire alarm", "instructor 2");
  EXPECT_TRUE(database.attempt(uuidOf(1))->excluded);
  EXPECT_EQ(database.attempt(uuidOf(1))->exclusionReason, "fire alarm (instructor 2)");
  database.includeAttempts({uuidOf(1)}, "heard nothing", "instructor 2");
  EXPECT_FALSE(database.attempt(uuidOf(1))->excluded);
  expectFault(ErrorKind::refused, "", {uuidOf(9)}, [&] { database.excludeAttempts({uuidOf(9)}, "x", "y"); });
  expectFault(ErrorKind::refused, "", {uuidOf(1)}, [&] { database.includeAttempts({uuidOf(1)}, "x", "y"); });
  expectFault(ErrorKind::invalid, "", {"exclusion", "reason"},
              [&] { database.excludeAttempts({uuidOf(1)}, " ", "y"); });
  expectFault(ErrorKind::invalid, "", {"exclusion", "who"}, [&] { database.includeAttempts({uuidOf(1)}, "x", ""); });
  SQLite::Database raw(path, SQLite::OPEN_READWRITE);
  EXPECT_EQ(raw.execAndGet("SELECT count(*) FROM audit WHERE action LIKE 'attempt-%'").getInt(), 3);
  EXPECT_THROW(raw.exec("DELETE FROM audit"), SQLite::Exception);
  EXPECT_THROW(raw.exec("UPDATE audit SET subject = ''"), SQLite::Exception);
}

TEST(AttemptDecisions, tagsAreKeptOnceAndAudited) {
  const Folder folder;
  const std::string path = folder.file("c.db");
  CohortDatabase database(path, Access::create);
  for (const unsigned n : {1U, 2U, 3U}) database.storeAttempt(attemptOf(n, "skilled"), valuesOf(n, n));
  EXPECT_EQ(database.tagAttempts({uuidOf(1), uuidOf(2)}, "teaching", "me"), 2U);
  EXPECT_EQ(database.tagAttempts({uuidOf(2), uuidOf(3)}, "teaching", "me"), 1U) << "one had it";
  EXPECT_EQ(database.tagAttempts({uuidOf(2)}, "bleeding", "me"), 1U);
  const std::vector<std::string> both{"bleeding", "teaching"};
  EXPECT_EQ(database.attempt(uuidOf(2))->tags, both);
  EXPECT_EQ(database.listAttempts()[1].tags, both);
  EXPECT_EQ(database.untagAttempts({uuidOf(1), uuidOf(2)}, "bleeding", "me"), 1U);
  EXPECT_EQ(database.attempt(uuidOf(2))->tags, std::vector<std::string>{"teaching"});
  database.storeAttempt(attemptOf(2, "skilled"), valuesOf(7, 7));
  EXPECT_EQ(database.attempt(uuidOf(2))->tags.size(), 1U) << "an import leaves them alone";
  const std::string longest = "\xC3\xA4" + std::string(39, 'a');
  EXPECT_EQ(database.tagAttempts({uuidOf(1)}, longest, "me"), 1U) << "40 characters, 41 bytes";
  for (const std::string& wrong :
       {std::string(), std::string("two words"), std::string("a,b"), std::string("a\nb"), longest + "a"})
    expectFault(ErrorKind::invalid, "", {"tag", "1", "40"}, [&] { database.tagAttempts({uuidOf(1)}, wrong, "me"); });
  expectFault(ErrorKind::invalid, "", {"tag", "who"}, [&] { database.tagAttempts({uuidOf(1)}, "x", " "); });
  expectFault(ErrorKind::refused, "", {uuidOf(9)}, [&] { database.tagAttempts({uuidOf(1), uuidOf(9)}, "x", "me"); });
  EXPECT_EQ(database.attempt(uuidOf(1))->tags.size(), 2U) << "all or none";
  SQLite::Database raw(path, SQLite::OPEN_READWRITE);
  EXPECT_EQ(raw.execAndGet("SELECT count(*) FROM audit WHERE action IN ('attempt-tag', 'attempt-untag')").getInt(), 6);
}

/// A list needs no line for a new column: it has every declared one that a struct holds, words instead of numbers.
TEST(AttemptFields, areTheDeclaredColumns) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  database.storeAttempt(attemptOf(1, "skilled"), valuesOf(1.0, 2.0));
  std::map<std::string, FieldValue> fields;
  for (const auto& [name, value] : fieldsOf(database.listAttempts().front()))
    EXPECT_TRUE(fields.emplace(name, value).second) << name;
  const std::vector<const DeclaredTable*> tables{&attemptTable, &recordingTable, &verificationTable};
  for (const DeclaredTable* table : tables) {
    for (const DeclaredColumn& column : table->columns) {
      if (column.member.value != nullptr) {
        EXPECT_TRUE(fields.contains(*column.listed != '\0' ? column.listed : column.name)) << column.name;
      }
    }
  }
  EXPECT_EQ(fields.at("attempt"), FieldValue(uuidOf(1)));
  EXPECT_EQ(fields.at("operator"), FieldValue("performer"));
  EXPECT_EQ(fields.at("outcome"), FieldValue("completed"));
  EXPECT_EQ(fields.at("verdict"), FieldValue("verified"));
  EXPECT_EQ(fields.at("synthetic"), FieldValue(true));
  EXPECT_EQ(fields.at("seed"), FieldValue(std::uint64_t{18446744073709551614ULL}));
  EXPECT_EQ(fields.at("seconds"), FieldValue(10.01));
}

}  // namespace
}  // namespace calot::analytics
