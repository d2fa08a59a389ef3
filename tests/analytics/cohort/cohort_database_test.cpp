// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/cohort/cohort_database.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <SQLiteCpp/SQLiteCpp.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <random>
#include <sstream>
#include <thread>

#include "analytics/assess.h"
#include "analytics/cohort/embedded.h"
#include "analytics/cohort/page_sums.h"
#include "analytics/cohort/tables.h"
#include "recorder/base/errors.h"
#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/support/fault.h"

namespace calot::analytics {
namespace {

using Access = CohortDatabase::Access;
using support::attemptOf;
using support::dump;
using support::Folder;
using support::humanAttempt;
using support::integrity;
using support::uuidOf;
using support::valuesOf;

TEST(CohortDatabase, isMadeWithItsSchema) {
  const Folder folder;
  const std::string path = folder.file("c.db");
  {
    const CohortDatabase database(path, Access::create);
    EXPECT_EQ(database.schemaVersion(), static_cast<int>(cohortMigrations().size()));
    EXPECT_TRUE(database.listAttempts().empty());
  }
  SQLite::Database raw(path, SQLite::OPEN_READONLY);
  EXPECT_EQ(raw.execAndGet("PRAGMA application_id").getInt(), 0x43616C6F);
  EXPECT_EQ(raw.execAndGet("PRAGMA journal_mode").getString(), "delete");
  SQLite::Statement tables(raw,
                           "SELECT name, strict FROM pragma_table_list WHERE schema = 'main' AND type = 'table' AND "
                           "name NOT LIKE 'sqlite_%'");
  int count = 0;
  while (tables.executeStep()) {
    ++count;
    EXPECT_EQ(tables.getColumn(1).getInt(), 1) << tables.getColumn(0).getString() << " is not STRICT";
  }
  int made = 0;
  for (const Migration& migration : cohortMigrations()) {
    const std::string sql = migration.sql;
    for (std::size_t at = 0; (at = sql.find("CREATE TABLE ", at)) != std::string::npos; ++at) ++made;
    for (std::size_t at = 0; (at = sql.find("DROP TABLE ", at)) != std::string::npos; ++at) --made;
  }
  EXPECT_EQ(count, made);
}

TEST(CohortDatabase, migrationsAreNumberedWithoutGaps) {
  const auto& migrations = cohortMigrations();
  ASSERT_FALSE(migrations.empty());
  for (std::size_t i = 0; i < migrations.size(); ++i) {
    EXPECT_EQ(std::string(migrations[i].name).substr(0, 5), fmt::format("{:04}_", i + 1));
    std::ifstream file(fmt::format("{}/schemas/cohort/{}", CALOT_SOURCE_DIR, migrations[i].name), std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    EXPECT_EQ(text, migrations[i].sql);
  }
}

TEST(CohortDatabase, olderSchemaIsBroughtUpToDate) {
  const Folder folder;
  const std::string path = folder.file("old.db");
  {
    SQLite::Database raw(path, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    raw.exec(cohortMigrations()[0].sql);
    raw.exec("PRAGMA user_version = 1; PRAGMA application_id = 1130458223");
    raw.exec(
        "INSERT INTO participant (pseudonym, study_group, created_utc) VALUES ('P01', 'expert', "
        "'2026-01-01T00:00:00Z')");
  }
  expectFault(ErrorKind::failure, path, {"1", std::to_string(cohortMigrations().size())},
              [&] { CohortDatabase(path, Access::read); }, {Remedy::upgradeCohort});
  CohortDatabase database(path, Access::write);
  EXPECT_EQ(database.schemaVersion(), static_cast<int>(cohortMigrations().size()));
  EXPECT_EQ(support::findParticipant(database, "P01")->group, "expert");
  SQLite::Database backup(path + ".schema-1.bak", SQLite::OPEN_READONLY);
  EXPECT_EQ(backup.execAndGet("PRAGMA user_version").getInt(), 1);
  EXPECT_EQ(backup.execAndGet("SELECT pseudonym FROM participant").getString(), "P01");
  EXPECT_EQ(database.storeAttempt(attemptOf(1, "skilled"), valuesOf(1.0, 2.0)), Imported::added);
}

TEST(CohortDatabase, refusesWhatIsNotItsOwn) {
  const Folder folder;
  const auto write = [&](const char* name, const std::string& bytes) {
    std::ofstream(folder.file(name), std::ios::binary) << bytes;
    return folder.file(name);
  };
  expectFault(ErrorKind::damaged, folder.file("none.db"), {},
              [&] { CohortDatabase(folder.file("none.db"), Access::read); });
  expectFault(ErrorKind::damaged, folder.file("none.db"), {},
              [&] { CohortDatabase(folder.file("none.db"), Access::write); });
  EXPECT_FALSE(std::filesystem::exists(folder.file("none.db")));
  expectFault(ErrorKind::failure, folder.file("nowhere/c.db"), {},
              [&] { CohortDatabase(folder.file("nowhere/c.db"), Access::create); });
  expectFault(ErrorKind::damaged, folder.file("."), {}, [&] { CohortDatabase(folder.file("."), Access::create); });
  const std::string empty = write("empty.db", "");
  expectFault(ErrorKind::damaged, empty, {}, [&] { CohortDatabase(empty, Access::read); });
  const std::string words = write("words.db", std::string(5000, 'x'));
  for (const Access access : {Access::read, Access::write, Access::create}) {
    expectFault(ErrorKind::damaged, words, {}, [&] { CohortDatabase(words, access); });
  }
  EXPECT_EQ(std::filesystem::file_size(words), 5000U);
  const std::string other = folder.file("other.db");
  { SQLite::Database(other, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE).exec("CREATE TABLE t (x)"); }
  for (const Access access : {Access::read, Access::write, Access::create}) {
    expectFault(ErrorKind::damaged, other, {}, [&] { CohortDatabase(other, access); });
  }
  const std::string newer = folder.file("newer.db");
  { const CohortDatabase database(newer, Access::create); }
  { SQLite::Database(newer, SQLite::OPEN_READWRITE, 0, pageSumLayer()).exec("PRAGMA user_version = 99"); }
  expectFault(ErrorKind::undecided, newer, {"99"}, [&] { CohortDatabase(newer, Access::read); });
  expectFault(ErrorKind::undecided, newer, {"99"}, [&] { CohortDatabase(newer, Access::create); });
  std::vector<std::string> faults;
  for (const std::string& file : {folder.file("none.db"), folder.file("."), empty, words, other}) {
    const auto error = caught([&] { CohortDatabase(file, Access::write); });
    faults.push_back(error ? error->fault() : "");
  }
  expectDistinct(faults);
}

TEST(CohortDatabase, truncatedOrOverwrittenFilesAreReportedNotCrashedOn) {
  const Folder folder;
  const std::string good = folder.file("good.db");
  {
    CohortDatabase database(good, Access::create);
    for (unsigned n = 0; n < 40; ++n) database.storeAttempt(attemptOf(n, "skilled"), valuesOf(n, n));
  }
  const auto size = std::filesystem::file_size(good);
  const unsigned seed = 31;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  int errors = 0;
  for (int round = 0; round < 80; ++round) {
    const std::string path = folder.file("bad.db");
    std::filesystem::copy_file(good, path, std::filesystem::copy_options::overwrite_existing);
    if (round % 2 == 0) {
      std::filesystem::resize_file(path, random() % size);
    } else {
      std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
      for (int i = 0; i < 200; ++i) {
        file.seekp(static_cast<std::streamoff>(random() % size));
        file.put(static_cast<char>(random()));
      }
    }
    try {
      const CohortDatabase database(path, Access::read);
      (void)database.allValues();
      (void)database.listAttempts();
    } catch (const Error& error) {
      ++errors;
      EXPECT_NE(std::string(error.what()).find("bad.db"), std::string::npos) << error.what();
      EXPECT_TRUE(error.kind() == ErrorKind::damaged || error.kind() == ErrorKind::undecided ||
                  error.kind() == ErrorKind::failure)
          << error.what();
    }
  }
  EXPECT_GE(errors, 40);
}

TEST(CohortDatabase, saysWhatTheMachineLacks) {
  expectDistinct({databaseError(SQLITE_NOMEM, "", "c.db").fault(), databaseError(SQLITE_FULL, "", "c.db").fault(),
                  databaseError(SQLITE_BUSY, "", "c.db").fault(), databaseError(SQLITE_INTERNAL, "", "c.db").fault()});
  expectNames(databaseError(SQLITE_NOMEM, "", "c.db").fault(), {"memory"});
}

TEST(CohortDatabase, keepsEverythingOfAnAttempt) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  AttemptRecord a = humanAttempt(7, "P07");
  a.parent = uuidOf(6);
  a.calibration = "2026-01-01";
  a.verification.text = "";
  const auto values = valuesOf(38.86, 0.06736);
  EXPECT_EQ(database.storeAttempt(a, values), Imported::added);
  const auto row = database.attempt(a.uuid);
  ASSERT_TRUE(row);
  EXPECT_EQ(row->uuid, a.uuid);
  EXPECT_EQ(row->parent, a.parent);
  EXPECT_EQ(row->participant, "P07");
  EXPECT_EQ(row->scene, a.scene);
  EXPECT_EQ(row->sceneMajor, a.sceneMajor);
  EXPECT_EQ(row->operatorKind, a.operatorKind);
  EXPECT_EQ(row->mode, a.mode);
  EXPECT_EQ(row->purpose, a.purpose);
  EXPECT_EQ(row->outcome, a.outcome);
  EXPECT_EQ(row->startUtc, a.startUtc);
  EXPECT_EQ(row->seed, a.seed);  // beyond SQLite's signed integers
  EXPECT_EQ(row->device, a.device);
  EXPECT_EQ(row->calibration, a.calibration);
  EXPECT_EQ(row->simulationVersion, a.simulationVersion);
  EXPECT_EQ(row->comparabilityKey, a.comparabilityKey);
  EXPECT_FALSE(row->synthetic);
  EXPECT_EQ(row->fileName, a.fileName);
  EXPECT_TRUE(row->complete);
  EXPECT_EQ(row->steps, a.steps);
  EXPECT_DOUBLE_EQ(row->stepSeconds, a.stepSeconds);
  EXPECT_EQ(row->chainHead, a.chainHead);
  EXPECT_EQ(row->verification.verdict, Verdict::verified);
  EXPECT_EQ(row->verification.software, "calot 0.1.0");
  EXPECT_FALSE(row->verifiedUtc.empty());
  EXPECT_EQ(database.values(a.uuid), values);
  EXPECT_FALSE(database.attempt(uuidOf(8)));
  EXPECT_TRUE(database.values(uuidOf(8)).empty());
  EXPECT_TRUE(support::findParticipant(database, "P07")) << "a participant named by an attempt is added";
}

TEST(CohortDatabase, storingTwiceChangesNothing) {
  const Folder folder;
  const std::string path = folder.file("c.db");
  CohortDatabase database(path, Access::create);
  database.storeAttempt(attemptOf(1, "skilled"), valuesOf(1, 2));
  const std::string once = dump(path);
  EXPECT_EQ(database.storeAttempt(attemptOf(1, "skilled"), valuesOf(1, 2)), Imported::unchanged);
  database.storeValues(uuidOf(1), valuesOf(1, 2));
  EXPECT_EQ(dump(path), once);
}

TEST(CohortDatabase, anotherContentOfTheSameUuidIsAConflict) {
  const Folder folder;
  const std::string path = folder.file("c.db");
  CohortDatabase database(path, Access::create);
  database.storeAttempt(attemptOf(1, "skilled"), valuesOf(1, 2));
  const std::string before = dump(path);
  const auto conflicts = [&](const char* what, auto change) {
    AttemptRecord other = attemptOf(1, "skilled");
    change(other);
    expectFault(ErrorKind::refused, "", {"conflict", what}, [&] { database.storeAttempt(other, valuesOf(3, 4)); });
  };
  conflicts("content", [](AttemptRecord& a) { a.chainHead[5] = std::byte{1}; });
  conflicts("content", [](AttemptRecord& a) {
    a.chainHead[5] = std::byte{1};
    a.steps += 10;
  });
  conflicts("content", [](AttemptRecord& a) {
    a.chainHead[5] = std::byte{1};
    a.steps += 10;
    a.complete = false;
  });
  conflicts("scene", [](AttemptRecord& a) { a.scene = "elsewhere"; });
  conflicts("seed", [](AttemptRecord& a) { a.seed = 5; });
  conflicts("operator", [](AttemptRecord& a) { a.profile = "unskilled"; });
  conflicts("participant", [](AttemptRecord& a) { a.participant = "P01"; });
  conflicts("simulation version", [](AttemptRecord& a) { a.simulationVersion = 2; });
  conflicts("diverged", [](AttemptRecord& a) { a.verification.verdict = Verdict::diverged; });
  conflicts("damaged", [](AttemptRecord& a) { a.verification.verdict = Verdict::damaged; });
  EXPECT_EQ(dump(path), before);
}

TEST(CohortDatabase, aLongerCopyOfAnIncompleteRecordingReplacesIt) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  AttemptRecord part = attemptOf(1, "skilled"), whole = part;
  part.complete = false;
  part.outcome = recorder::Outcome::running;
  part.steps = 400;
  part.chainHead[1] = std::byte{9};
  EXPECT_EQ(database.storeAttempt(part, valuesOf(4, 1)), Imported::added);
  EXPECT_EQ(database.storeAttempt(whole, valuesOf(10, 2)), Imported::extended);
  EXPECT_TRUE(database.attempt(whole.uuid)->complete);
  EXPECT_EQ(database.attempt(whole.uuid)->outcome, recorder::Outcome::completed);
  EXPECT_DOUBLE_EQ(*database.values(whole.uuid)[0].value, 10.0);
  // The earlier copy, coming late, takes nothing away.
  EXPECT_EQ(database.storeAttempt(part, valuesOf(4, 1)), Imported::unchanged);
  EXPECT_DOUBLE_EQ(*database.values(whole.uuid)[0].value, 10.0);
}

TEST(CohortDatabase, aBuildThatCannotJudgeTakesNothingAway) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  const AttemptRecord a = attemptOf(1, "skilled");
  database.storeAttempt(a, valuesOf(1, 2));
  AttemptRecord blind = a;
  blind.verification = {Verdict::notCheckableHere, "simulation version 1, this build has 2", "calot 0.2.0"};
  EXPECT_EQ(database.storeAttempt(blind, {}), Imported::unchanged);
  EXPECT_EQ(database.attempt(a.uuid)->verification.verdict, Verdict::verified);
  EXPECT_EQ(database.values(a.uuid).size(), 3U);
}

TEST(CohortDatabase, refusesRecordsThatNoRecordingHas) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  AttemptRecord a = attemptOf(1, "skilled");
  a.uuid = "not-a-uuid";
  expectFault(ErrorKind::damaged, "", {"\"" + a.uuid + "\""}, [&] { database.storeAttempt(a, {}); });
  a = attemptOf(1, "skilled");
  a.uuid[0] = '\'';
  expectFault(ErrorKind::damaged, "", {"\"" + a.uuid + "\""}, [&] { database.storeAttempt(a, {}); });
  a = attemptOf(1, "skilled");
  a.steps = ~0ULL;
  expectFault(ErrorKind::damaged, a.fileName, {"steps"}, [&] { database.storeAttempt(a, {}); });
  EXPECT_TRUE(database.listAttempts().empty());
}

TEST(CohortDatabase, participantsAreAddedAndChanged) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  database.addParticipant({"P01", "expert", "A", "north", {{"laparoscopies", "240"}}, {{"research", "2026-02-28"}}});
  expectFault(ErrorKind::refused, "", {"\"P01\""}, [&] { database.addParticipant({"P01", "", "", "", {}, {}}); });
  database.setParticipant("P01", {.group = std::nullopt,
                                  .arm = "B",
                                  .site = std::nullopt,
                                  .experience = {{"level", "attending"}, {"laparoscopies", "241"}},
                                  .consent = {}});
  const auto p = support::findParticipant(database, "P01");
  ASSERT_TRUE(p);
  EXPECT_EQ(p->group, "expert");
  EXPECT_EQ(p->arm, "B");
  EXPECT_EQ(p->experience, (std::map<std::string, std::string>{{"laparoscopies", "241"}, {"level", "attending"}}));
  EXPECT_EQ(p->consent.at("research"), "2026-02-28");
  expectFault(ErrorKind::refused, "", {"\"P02\""}, [&] { database.setParticipant("P02", {}); });
  for (const char* bad : {"", " P", "P\n1"}) {
    expectFault(ErrorKind::invalid, "", {"pseudonym"}, [&] { database.addParticipant({bad, "", "", "", {}, {}}); });
  }
  for (const char* bad : {"", "2026-02-29", "2026-13-01", "26-01-01", "2026/01/01", "2026-01-01x", "2026-0a-01"}) {
    expectFault(ErrorKind::invalid, "", {"research", std::string("\"") + bad + "\""}, [&] {
      database.addParticipant({"P03", "", "", "", {}, {{"research", bad}}});
    });
  }
  EXPECT_EQ(database.participants().size(), 1U);
}

TEST(CohortDatabase, groupsCountParticipantsAndAttempts) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  database.addParticipant({"E1", "expert", "", "", {}, {}});
  database.addParticipant({"E2", "expert", "", "", {}, {}});
  database.storeAttempt(humanAttempt(1, "E1"), {});
  database.storeAttempt(humanAttempt(2, "E1"), {});
  database.storeAttempt(attemptOf(3, "skilled"), {});
  const auto groups = database.groups();
  ASSERT_EQ(groups.size(), 2U);
  EXPECT_EQ(groups[0].group, "");
  EXPECT_EQ(groups[0].participants, 0U);
  EXPECT_EQ(groups[0].attempts, 1U);
  EXPECT_EQ(groups[1].group, "expert");
  EXPECT_EQ(groups[1].participants, 2U);
  EXPECT_EQ(groups[1].attempts, 2U);
}

TEST(CohortDatabase, manyMayMakeItAtOnce) {
  const Folder folder;
  constexpr int rounds = 40, makers = 6;
  int failed = 0;
  for (int round = 0; round < rounds; ++round) {
    const std::string path = folder.file(fmt::format("{}.db", round));
    std::array<int, 2> gate{};
    ASSERT_EQ(::pipe(gate.data()), 0);
    std::vector<pid_t> children;
    for (int maker = 0; maker < makers; ++maker) {
      const pid_t child = ::fork();
      if (child == 0) {
        ::close(gate[1]);
        char byte = 0;
        (void)::read(gate[0], &byte, 1);  // until all are there
        try {
          const CohortDatabase database(path, Access::create);
        } catch (const std::exception& error) {
          std::cerr << error.what() << '\n';
          ::_exit(1);
        }
        ::_exit(0);
      }
      children.push_back(child);
    }
    ::close(gate[0]);
    ::close(gate[1]);
    for (const pid_t child : children) {
      int status = 0;
      ASSERT_EQ(::waitpid(child, &status, 0), child);
      if (status != 0) ++failed;
    }
  }
  EXPECT_EQ(failed, 0);
}

TEST(CohortDatabase, twoWritersBothGetThrough) {
  const Folder folder;
  const std::string path = folder.file("c.db");
  constexpr unsigned each = 60;
  std::vector<pid_t> children;
  for (unsigned writer = 0; writer < 2; ++writer) {
    const pid_t child = ::fork();
    if (child == 0) {
      int status = 0;
      try {
        CohortDatabase database(path, Access::create);  // both make it
        for (unsigned n = 0; n < each; ++n)
          database.storeAttempt(attemptOf(writer * 1000 + n, "skilled"), valuesOf(n, n));
        database.storeAttempt(attemptOf(5000, "skilled"), valuesOf(1, 1));  // the same one
      } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
        status = 1;
      }
      ::_exit(status);
    }
    children.push_back(child);
  }
  for (const pid_t child : children) {
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
  }
  EXPECT_EQ(CohortDatabase(path, Access::read).listAttempts().size(), 2 * each + 1);
  EXPECT_EQ(integrity(path), "ok");
}

TEST(CohortDatabase, aWriterThatNeverEndsIsReported) {
  const Folder folder;
  const std::string path = folder.file("c.db");
  CohortDatabase database(path, Access::create, std::chrono::milliseconds(50));
  SQLite::Database other(path, SQLite::OPEN_READWRITE);
  other.exec("BEGIN IMMEDIATE");
  expectFault(ErrorKind::failure, path, {}, [&] { database.storeAttempt(attemptOf(1, "skilled"), {}); });
  EXPECT_TRUE(database.listAttempts().empty()) << "readers go on";
  other.exec("ROLLBACK");
  EXPECT_EQ(database.storeAttempt(attemptOf(1, "skilled"), {}), Imported::added);
}

TEST(CohortDatabase, killedAtAnyMomentItHoldsWholeAttemptsOnly) {
  const Folder folder;
  const std::string path = folder.file("c.db");
  const unsigned seed = 9;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  unsigned before = 0;
  for (int round = 0; round < 25; ++round) {
    std::array<int, 2> begun{};
    ASSERT_EQ(::pipe(begun.data()), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      try {
        CohortDatabase database(path, Access::create);
        for (unsigned n = 0;; ++n) {
          database.storeAttempt(attemptOf(n, "skilled"), valuesOf(n, n));
          if (n == before) (void)::write(begun[1], "x", 1);
        }
      } catch (...) {
      }
      ::_exit(1);
    }
    ::close(begun[1]);
    // Every other time from a new attempt on, however busy the machine; else at any moment, of opening too.
    char byte = 0;
    if (round % 2 == 1) {
      EXPECT_EQ(::read(begun[0], &byte, 1), 1);
    }
    ::close(begun[0]);
    std::this_thread::sleep_for(std::chrono::microseconds(1000 + random() % 30000));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    const CohortDatabase database(path, Access::create);
    const auto attempts = database.listAttempts();
    EXPECT_GE(attempts.size(), before);
    before = static_cast<unsigned>(attempts.size());
    for (const AttemptRow& a : attempts) EXPECT_EQ(database.values(a.uuid).size(), 3U) << a.uuid;
    EXPECT_EQ(integrity(path), "ok");
  }
  EXPECT_GT(before, 0U);
}

TEST(CohortDatabase, aFullDiskLosesNothingThatWasThere) {
  const Folder folder;
  const std::string path = folder.file("c.db");
  {
    CohortDatabase database(path, Access::create);
    for (unsigned n = 0; n < 20; ++n) database.storeAttempt(attemptOf(n, "skilled"), valuesOf(n, n));
  }
  const auto size = std::filesystem::file_size(path);
  const pid_t child = ::fork();
  if (child == 0) {
    // Stands for the full disk: no file may grow beyond the database's present size and a bit.
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{size + 20000, size + 20000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    int status = 1;
    try {
      CohortDatabase database(path, Access::write);
      for (unsigned n = 20; n < 3000; ++n) database.storeAttempt(attemptOf(n, "skilled"), valuesOf(n, n));
    } catch (const Error& error) {
      status = error.kind() == ErrorKind::failure && error.where().file == path ? 0 : 2;
      if (status != 0) std::cerr << error.what() << '\n';
    }
    ::_exit(status);
  }
  int status = -1;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(integrity(path), "ok");
  const CohortDatabase database(path, Access::write);
  const auto attempts = database.listAttempts();
  EXPECT_GE(attempts.size(), 20U);
  for (const AttemptRow& a : attempts) EXPECT_EQ(database.values(a.uuid).size(), 3U);
}

TEST(CohortDatabase, saysInWordsWhatSqliteSaysInNumbers) {
  expectFault(ErrorKind::failure, "c.db", {"disk"}, databaseError(SQLITE_FULL, "", "c.db"));
  expectFault(ErrorKind::failure, "c.db", {"permissions"}, databaseError(SQLITE_READONLY, "", "c.db"));
  EXPECT_EQ(databaseError(SQLITE_CORRUPT, "", "c.db").kind(), ErrorKind::damaged);
  EXPECT_EQ(databaseError(SQLITE_IOERR_READ, "x", "c.db").kind(), ErrorKind::failure);  // extended codes too
}

TEST(Assess, storesWhatAReplayGave) {
  const Folder folder;
  CohortDatabase database(folder.file("c.db"), Access::create);
  recorder::AttemptHeader header;
  header.attempt = uuidOf(3);
  header.startUtc = "2026-01-01T00:00:00Z";
  header.sceneName = "touch-liver";
  header.sceneMajor = 1;
  header.simulationVersion = 1;
  header.stepResultVersion = 1;
  header.provenance.profile = "skilled";
  header.mode = recorder::Mode::assessment;
  recorder::ReplayReport report;
  report.verdict = recorder::ReplayVerdict::exact;
  report.outcome = recorder::Outcome::completed;
  report.complete = true;
  report.steps = 100;
  const AttemptRecord record = recordOf(header, report, "some/folder/r.h5");
  EXPECT_EQ(database.storeAttempt(record, valuesOf(1.0, 0.5)), Imported::added);
  EXPECT_EQ(database.storeAttempt(record, valuesOf(1.0, 0.5)), Imported::unchanged);
  const auto row = database.attempt(uuidOf(3));
  ASSERT_TRUE(row);
  EXPECT_EQ(row->fileName, "r.h5");
  EXPECT_TRUE(row->synthetic);
  EXPECT_EQ(row->comparabilityKey,
            "touch-liver/1 device=performer calibration=- simulation=1 results=1 mode=assessment");
}

}  // namespace
}  // namespace calot::analytics
