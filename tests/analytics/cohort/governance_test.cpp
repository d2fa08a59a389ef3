// SPDX-License-Identifier: GPL-3.0-or-later
// Merging, withdrawing, checking: what the command line's tests cannot vary as widely.
#include <gtest/gtest.h>

#include <SQLiteCpp/SQLiteCpp.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <set>

#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/embedded.h"
#include "analytics/cohort/page_sums.h"
#include "analytics/cohort/registers.h"
#include "analytics/cohort/withdraw.h"
#include "analytics/regrade.h"
#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/support/fault.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using Access = CohortDatabase::Access;
using support::attemptOf;
using support::Folder;
using support::humanAttempt;
using support::uuidOf;
using support::valuesOf;

/// What people read of a database: no numbers of rows, no times, no audit.
std::multiset<std::string> meaning(const std::string& path) {
  std::multiset<std::string> rows;
  const CohortDatabase database(path, Access::read);
  for (const Participant& p : database.participants()) {
    std::string row = fmt::format("participant {} {} {} {}", p.pseudonym, p.group, p.arm, p.site);
    for (const auto& [k, v] : p.experience) row += fmt::format(" {}={}", k, v);
    for (const auto& [k, v] : p.consent) row += fmt::format(" {}:{}", k, v);
    rows.insert(row);
  }
  for (const AttemptRow& a : database.listAttempts()) {
    std::string row = fmt::format("attempt {} {} {} {}", a.uuid, a.participant, a.steps, a.exclusionReason);
    for (const std::string& tag : a.tags) row += " #" + tag;
    for (const CheckpointValue& v : database.values(a.uuid))
      row += fmt::format(" {}/{}={}", v.name, v.subject, v.value.value_or(-1.0));
    rows.insert(row);
  }
  return rows;
}

std::string bytesOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

TEST(Merge, isTheUnionWhicheverWayRoundAndDoneTwiceIsDoneOnce) {
  const unsigned seed = 5;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (int round = 0; round < 12; ++round) {
    const Folder folder;
    const std::string a = folder.file("a.db"), b = folder.file("b.db"), c = folder.file("c.db");
    for (const std::string& path : {a, b}) {
      CohortDatabase database(path, Access::create);
      for (unsigned n = 1; n <= 12; ++n) {
        if (random() % 3 == 0) continue;
        AttemptRecord attempt = humanAttempt(n, fmt::format("P{}", n % 4));
        if (random() % 4 == 0) {  // a copy that was cut short
          attempt.complete = false;
          attempt.outcome = recorder::Outcome::running;
          attempt.steps = 400;
          attempt.chainHead[1] = std::byte{9};
        }
        database.storeAttempt(attempt, valuesOf(attempt.complete ? n : 0.5 * n, n));
        if (n % 5 == 0) database.excludeAttempts({attempt.uuid}, "alarm", "me");
        if (random() % 3 == 0) database.tagAttempts({attempt.uuid}, random() % 2 == 0 ? "teaching" : "odd", "me");
      }
      if (support::findParticipant(database, "P1")) {
        ParticipantChange change;
        if (random() % 2 == 0) change.group = "expert";
        if (random() % 2 == 0) change.experience["level"] = "attending";
        database.setParticipant("P1", change);
      }
    }
    std::filesystem::copy_file(b, c);
    { const CohortDatabase settle(c, Access::write); }
    const CohortMerge first = mergeCohorts(a, b);
    EXPECT_TRUE(first.conflicts.empty()) << first.conflicts.front();
    const auto once = meaning(a);
    EXPECT_FALSE(mergeCohorts(a, b).changed());
    EXPECT_EQ(meaning(a), once);
    mergeCohorts(c, a);
    EXPECT_EQ(meaning(c), once) << "merging is the same either way round";
    EXPECT_FALSE(mergeCohorts(a, c).changed());
    EXPECT_TRUE(checkCohort(a).faults.empty());
  }
}

TEST(Merge, reportsEveryConflictAndChangesNothing) {
  const Folder folder;
  const std::string a = folder.file("a.db"), b = folder.file("b.db");
  {
    CohortDatabase one(a, Access::create), two(b, Access::create);
    one.addParticipant({"P1", "expert", "", "north", {{"level", "1"}}, {}});
    two.addParticipant({"P1", "novice", "", "south", {{"level", "2"}}, {}});
    one.storeAttempt(attemptOf(1, "skilled"), valuesOf(1, 1));
    AttemptRecord other = attemptOf(1, "skilled");
    other.chainHead[7] = std::byte{7};
    two.storeAttempt(other, valuesOf(1, 1));
    two.storeAttempt(attemptOf(2, "skilled"), valuesOf(1, 1));
  }
  const auto before = meaning(a);
  const CohortMerge merge = mergeCohorts(a, b);
  EXPECT_EQ(merge.conflicts.size(), 4U);  // group, site, level, content
  EXPECT_EQ(meaning(a), before);
  expectFault(ErrorKind::invalid, a, {}, [&] { mergeCohorts(a, a); });
}

TEST(Withdrawal, reachesTablesThatItDoesNotKnow) {
  const Folder folder;
  const std::string path = folder.file("c.db");
  {
    CohortDatabase database(path, Access::create);
    database.storeAttempt(humanAttempt(1, "Gone-1"), valuesOf(1, 1));
    database.storeAttempt(humanAttempt(2, "Stays"), valuesOf(2, 2));
  }
  {
    // As a later migration might add them: by number, by number of a number, by uuid alone.
    SQLite::Database raw(path, SQLite::OPEN_READWRITE, 0, pageSumLayer());
    raw.exec(
        "CREATE TABLE later (id INTEGER PRIMARY KEY, attempt INTEGER NOT NULL REFERENCES attempt (id), words TEXT) "
        "STRICT; CREATE TABLE later_item (later INTEGER NOT NULL REFERENCES later (id), words TEXT) STRICT; "
        "CREATE TABLE loose (uuid TEXT, words TEXT) STRICT; "
        "INSERT INTO later SELECT id, id, 'of Gone-1' FROM attempt; INSERT INTO later_item SELECT id, 'item' FROM "
        "later; INSERT INTO loose SELECT uuid, 'word' FROM attempt");
  }
  const Withdrawal plan = planWithdrawal(path, "Gone-1", WithdrawalScope::all);
  EXPECT_EQ(plan.attempts, std::vector<std::string>{uuidOf(1)});
  withdraw(path, plan);
  SQLite::Database raw(path, SQLite::OPEN_READONLY);
  EXPECT_EQ(raw.execAndGet("SELECT count(*) FROM later").getInt(), 1);
  EXPECT_EQ(raw.execAndGet("SELECT count(*) FROM later_item").getInt(), 1);
  EXPECT_EQ(raw.execAndGet("SELECT count(*) FROM loose").getInt(), 1);
  // A free text of somebody else's row is not ours to delete, but it is found.
  EXPECT_EQ(placesLeft(path, {}, {"Gone-1"}), std::vector<std::string>{"later.words"});
  const std::string minute = raw.execAndGet("SELECT substr(start_utc, 15, 2) FROM attempt").getString();
  EXPECT_TRUE(placesLeft(path, {}, {minute}).empty()) << minute;
  EXPECT_EQ(bytesOf(path).find(uuidOf(1)), std::string::npos);
  EXPECT_TRUE(wasWithdrawn(path, uuidOf(1)));
  CohortDatabase database(path, Access::write);
  expectFault(ErrorKind::refused, "", {"withdrawn"}, [&] { database.storeAttempt(humanAttempt(1, "Gone-1"), {}); });
  AttemptRecord branch = attemptOf(3, "skilled");
  branch.parent = uuidOf(1);
  expectFault(ErrorKind::refused, "", {"branches", "withdrawn"}, [&] { database.storeAttempt(branch, {}); });
}

TEST(Withdrawal, aPseudonymWithinALongerOneIsAnother) {
  EXPECT_TRUE(namesWord("P1", "P1"));
  EXPECT_TRUE(namesWord("with P1; then", "P1"));
  EXPECT_TRUE(namesWord("P10 and P1", "P1"));
  EXPECT_FALSE(namesWord("P10", "P1"));
  EXPECT_FALSE(namesWord("XP1", "P1"));
  EXPECT_FALSE(namesWord("P1-b", "P1"));
  EXPECT_FALSE(namesWord("anything", ""));
}

TEST(Withdrawal, auditRowsStayAndLoseTheirWordsOnlyThen) {
  const Folder folder;
  const std::string path = folder.file("c.db");
  CohortDatabase(path, Access::create).storeAttempt(humanAttempt(1, "Gone-1"), valuesOf(1, 1));
  const auto count = [&] {
    return SQLite::Database(path, SQLite::OPEN_READONLY).execAndGet("SELECT count(*) FROM audit").getInt();
  };
  const int before = count();
  withdraw(path, planWithdrawal(path, "Gone-1", WithdrawalScope::all));
  EXPECT_EQ(count(), before + 1);
  SQLite::Database raw(path, SQLite::OPEN_READWRITE);
  EXPECT_EQ(raw.execAndGet("SELECT count(*) FROM audit WHERE subject LIKE 'withdrawn %'").getInt(), before + 1);
  EXPECT_THROW(raw.exec("UPDATE audit SET detail = 'x'"), SQLite::Exception);
  EXPECT_THROW(raw.exec("UPDATE audit SET subject = 'withdrawn nobody', detail = ''"), SQLite::Exception);
  EXPECT_THROW(raw.exec("DELETE FROM audit"), SQLite::Exception);
}

TEST(Registers, aStationsKeyStaysWhatItIs) {
  const Folder folder;
  const std::string path = folder.file("c.db");
  PublicKey key{}, other{};
  key[3] = std::byte{3};
  setStation(path, "S1", "north", key, {});
  setStation(path, "S1", {}, key, "by the window");
  expectFault(ErrorKind::refused, "", {"\"S1\""}, [&] { setStation(path, "S1", {}, other, {}); });
  const Registers r = readRegisters(path);
  ASSERT_EQ(r.stations.size(), 1U);
  EXPECT_EQ(r.stations[0].note, "by the window");
  ASSERT_EQ(r.sites.size(), 1U);
  EXPECT_EQ(standingOf(r, "S1", key), KeyStanding::known);
  EXPECT_EQ(standingOf(r, "S1", other), KeyStanding::another);
  EXPECT_EQ(standingOf(r, "S1", {}), KeyStanding::unsignedButExpected);
  EXPECT_EQ(standingOf(r, "S2", key), KeyStanding::unregistered);
  EXPECT_EQ(standingOf(r, "S2", {}), KeyStanding::unsignedAndUnknown);
}

TEST(Signatures, areKeptAsSeenAtImport) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  AttemptRecord bare = attemptOf(1, "skilled"), one = bare, two = bare;
  one.signature.emplace().publicKey[0] = std::byte{1};
  two.signature.emplace().publicKey[0] = std::byte{2};
  EXPECT_EQ(database.storeAttempt(bare, {}), Imported::added);
  EXPECT_EQ(database.storeAttempt(one, {}), Imported::extended) << "signed after it came in";
  EXPECT_EQ(database.storeAttempt(bare, {}), Imported::unchanged) << "a copy without it takes nothing away";
  EXPECT_EQ(database.attempt(uuidOf(1))->signature, one.signature);
  expectFault(ErrorKind::refused, "", {"signer"}, [&] { database.storeAttempt(two, {}); });
  EXPECT_TRUE(checkCohort(folder.file("c.db")).faults.empty());
}

TEST(Check, namesTablesThatAreNotAsDeclared) {
  const Folder folder;
  const std::string path = folder.file("c.db");
  { const CohortDatabase made(path, CohortDatabase::Access::create); }
  SQLite::Database raw(path, SQLite::OPEN_READWRITE, 0, pageSumLayer());
  raw.exec("ALTER TABLE attempt ADD COLUMN stray TEXT");
  raw.exec("ALTER TABLE site RENAME COLUMN note TO remark");
  const std::vector<std::string> faults = checkCohort(path).faults;
  EXPECT_EQ(faults.size(), 2U);
  for (const char* table : {"site", "attempt"}) {
    EXPECT_EQ(
        std::count_if(faults.begin(), faults.end(), [&](const std::string& fault) { return holdsToken(fault, table); }),
        1)
        << table;
  }
}

TEST(Regrade, namesWhatChanged) {
  const auto before = valuesOf(1.0, 2.0);
  auto now = valuesOf(1.0, 3.0);
  now.erase(now.begin() + 2);
  now.push_back(makeValue(*findCheckpoint("attempt-duration"), "", Origin::resimulated, 4.0));
  const std::vector<ValueChange> changes = changesOf(before, now);
  ASSERT_EQ(changes.size(), 3U);
  EXPECT_EQ(changes[0].before->value, 2.0);
  EXPECT_EQ(changes[0].now->value, 3.0);
  EXPECT_FALSE(changes[1].before);
  EXPECT_EQ(changes[1].now->name, "attempt-duration");
  EXPECT_FALSE(changes[2].now);
  EXPECT_EQ(changes[2].before->subject, "right");
  EXPECT_TRUE(changesOf(before, before).empty());
}

TEST(Values, onlyRowsThatDifferAreWritten) {
  const Folder folder;
  const std::string path = folder.file("c.db");
  CohortDatabase database(path, Access::create);
  database.storeAttempt(attemptOf(1, "skilled"), valuesOf(1, 2));
  {
    // Counts what is written, row by row.
    SQLite::Database raw(path, SQLite::OPEN_READWRITE, 0, pageSumLayer());
    raw.exec(
        "CREATE TABLE written (name TEXT) STRICT; CREATE TRIGGER watch AFTER INSERT ON checkpoint_value BEGIN INSERT "
        "INTO written VALUES (NEW.name || ' ' || NEW.subject); END");
  }
  database.storeValues(uuidOf(1), valuesOf(1, 3));
  {
    SQLite::Database raw(path, SQLite::OPEN_READONLY);
    EXPECT_EQ(raw.execAndGet("SELECT group_concat(name) FROM written").getString(), "path-length left");
  }
  // An order that moved: every row changes places without meeting its old self.
  auto turned = valuesOf(1, 3);
  std::rotate(turned.begin(), turned.begin() + 1, turned.end());
  database.storeValues(uuidOf(1), turned);
  EXPECT_EQ(database.values(uuidOf(1)), turned);
}

}  // namespace
}  // namespace calot::analytics
