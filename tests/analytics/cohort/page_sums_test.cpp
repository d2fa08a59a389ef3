// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/cohort/page_sums.h"

#include <gtest/gtest.h>
#include <SQLiteCpp/SQLiteCpp.h>
#include <algorithm>
#include <cstring>
#include <fstream>
#include <random>
#include <sstream>
#include <thread>

#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/embedded.h"
#include "recorder/base/errors.h"
#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/support/fault.h"

namespace calot::analytics::cohort_pages_test {
namespace {

using Access = CohortDatabase::Access;
using support::attemptOf;
using support::dump;
using support::Folder;
using support::integrity;
using support::uuidOf;
using support::valuesOf;

TEST(CohortPages, pagesAreReadOnlyAsTheyWereWritten) {
  const Folder folder;
  const std::string good = folder.file("good.db"), bad = folder.file("bad.db");
  {
    CohortDatabase database(good, Access::create);
    for (unsigned n = 0; n < 20; ++n) database.storeAttempt(attemptOf(n, "skilled"), valuesOf(n, n));
  }
  const auto size = std::filesystem::file_size(good);
  std::mt19937 random(44);
  for (int round = 0; round < 60; ++round) {
    const auto at = 100 + random() % (size - 100);
    std::filesystem::copy_file(good, bad, std::filesystem::copy_options::overwrite_existing);
    std::fstream file(bad, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(static_cast<std::streamoff>(at));
    const auto byte = static_cast<char>(file.get() ^ (1 << random() % 8));
    file.seekp(static_cast<std::streamoff>(at));
    file.put(byte);
    file.close();
    expectFault(ErrorKind::damaged, bad, {"page", std::to_string(at / 4096 + 1), "checksum"},
                [&] { checkCohort(bad); });
  }
}

TEST(CohortPages, oneBitOfAFigureIsFoundByWhoeverReadsIt) {
  const Folder folder;
  const std::string path = folder.file("c.db");
  constexpr double figure = 12345.678;
  CohortDatabase(path, Access::create).storeAttempt(attemptOf(1, "skilled"), valuesOf(figure, 2.0));
  std::string stored(sizeof figure, '\0');
  std::memcpy(stored.data(), &figure, sizeof figure);
  std::reverse(stored.begin(), stored.end());
  std::stringstream held;
  held << std::ifstream(path, std::ios::binary).rdbuf();
  std::string bytes = held.str();
  const std::size_t at = bytes.find(stored);
  ASSERT_NE(at, std::string::npos);
  bytes[at + 5] ^= 1;
  std::ofstream(path, std::ios::binary) << bytes;
  EXPECT_EQ(integrity(path), "ok") << "SQLite sees nothing";
  const std::vector<std::string> page{std::to_string(at / 4096 + 1), "checksum"};
  expectFault(ErrorKind::damaged, path, page,
              [&] { static_cast<void>(CohortDatabase(path, Access::read).allValues()); });
  expectFault(ErrorKind::damaged, path, page,
              [&] { static_cast<void>(CohortDatabase(path, Access::read).values(uuidOf(1))); });
  expectFault(ErrorKind::damaged, path, page, [&] { refuseUnsound(path); });
  expectFault(ErrorKind::damaged, path, page, [&] { mergeCohorts(folder.file("all.db"), path); });
}

TEST(CohortPages, aCopyFromTheMiddleOfACommitIsNoDatabase) {
  const Folder folder;
  const std::string path = folder.file("c.db"), alone = folder.file("alone.db"), whole = folder.file("whole.db");
  {
    CohortDatabase database(path, Access::create);
    for (unsigned n = 0; n < 200; ++n) database.storeAttempt(attemptOf(n, "skilled"), valuesOf(n, n));
  }
  const std::string before = dump(path);
  SQLite::Database raw(path, SQLite::OPEN_READWRITE, 0, pageSumLayer());
  raw.exec("PRAGMA cache_size = 1; BEGIN IMMEDIATE; UPDATE checkpoint_value SET value = value + 1 WHERE value > 0");
  std::filesystem::copy_file(path, alone);
  std::filesystem::copy_file(path, whole);
  std::filesystem::copy_file(path + "-journal", whole + "-journal");
  raw.exec("ROLLBACK");
  expectFault(ErrorKind::damaged, alone, {"copy", "wrote"}, [&] { checkCohort(alone); });
  for (const std::string& file : {path, whole}) {
    EXPECT_TRUE(checkCohort(file).faults.empty());
    EXPECT_EQ(dump(file), before);
  }
}

TEST(CohortPages, pagesOfOlderOnesGetTheirSums) {
  const Folder folder;
  const std::string path = folder.file("old.db");
  {
    SQLite::Database raw(path, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    raw.exec("PRAGMA journal_mode = WAL");
    for (std::size_t i = 0; i + 1 < cohortMigrations().size(); ++i) raw.exec(cohortMigrations()[i].sql);
    raw.exec("PRAGMA application_id = 1130458223; PRAGMA user_version = 13");
    raw.exec(
        "WITH RECURSIVE n (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 20000) INSERT INTO participant "
        "(pseudonym, created_utc) SELECT 'P' || i, '2026-01-01T00:00:00Z' FROM n");
  }
  std::vector<std::thread> openers;
  for (int i = 0; i < 3; ++i) openers.emplace_back([&] { CohortDatabase(path, Access::write); });
  for (std::thread& opener : openers) opener.join();
  EXPECT_FALSE(std::filesystem::exists(path + "-wal"));
  const CohortCheck check = checkCohort(path);
  EXPECT_EQ(check.faults, std::vector<std::string>{});
  EXPECT_EQ(check.participants, 20000U);
}

}  // namespace
}  // namespace calot::analytics::cohort_pages_test
