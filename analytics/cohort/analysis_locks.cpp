// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/cohort/analysis_locks.h"

#include <fmt/format.h>
#include <sodium.h>

#include <chrono>

#include "analytics/cohort/connection.h"
#include "analytics/cohort/row_statements.h"
#include "analytics/cohort/tables.h"

namespace calot::analytics {
namespace {

using namespace tables;

constexpr auto lockPatience = std::chrono::seconds(10);

/// An older schema, which reading does not migrate, has neither masks nor locks.
bool hasLocks(SQLite::Database& db) { return db.tableExists("analysis_lock"); }

std::optional<bool> findMask(SQLite::Database& db, const std::string& protocol) {
  SQLite::Statement find(db, "SELECT swapped FROM group_mask WHERE protocol_sha256 = ?");
  find.bind(1, protocol);
  return find.executeStep() ? std::optional(find.getColumn(0).getInt() != 0) : std::nullopt;
}

std::optional<AnalysisLock> findLock(SQLite::Database& db, const std::string& protocol) {
  const auto locks = selectRows(db, analysisLockTable(), "WHERE protocol_sha256 = ?", protocol);
  return locks.empty() ? std::nullopt : std::optional(locks.front());
}

}  // namespace

std::optional<bool> readGroupMask(const std::string& path, const std::string& protocolSha256) {
  return guarded(path, [&]() -> std::optional<bool> {
    const auto db = openCohort(path, CohortDatabase::Access::read, lockPatience);
    return hasLocks(*db) ? findMask(*db, protocolSha256) : std::nullopt;
  });
}

bool drawGroupMask(const std::string& path, const std::string& protocolSha256) {
  [[maybe_unused]] static const int ready = sodium_init();
  return guarded(path, [&] {
    const auto db = openCohort(path, CohortDatabase::Access::write, lockPatience);
    SQLite::Transaction transaction(*db, SQLite::TransactionBehavior::IMMEDIATE);
    if (const std::optional<bool> known = findMask(*db, protocolSha256)) return *known;
    const bool swapped = randombytes_uniform(2) == 1;
    SQLite::Statement put(*db, "INSERT INTO group_mask VALUES (?, ?, ?)");
    SQLite::bind(put, protocolSha256, swapped ? 1 : 0, nowUtc());
    put.exec();
    audit(*db, "group-mask", protocolSha256, "");
    transaction.commit();
    return swapped;
  });
}

std::optional<AnalysisLock> readAnalysisLock(const std::string& path, const std::string& protocolSha256) {
  return guarded(path, [&]() -> std::optional<AnalysisLock> {
    const auto db = openCohort(path, CohortDatabase::Access::read, lockPatience);
    return hasLocks(*db) ? findLock(*db, protocolSha256) : std::nullopt;
  });
}

AnalysisLock storeAnalysisLock(const std::string& path, const AnalysisLock& lock, bool& added) {
  if (lock.by.empty()) throw Error(ErrorKind::invalid, "protocol: name who locks the analysis");
  return guarded(path, [&] {
    const auto db = openCohort(path, CohortDatabase::Access::write, lockPatience);
    SQLite::Transaction transaction(*db, SQLite::TransactionBehavior::IMMEDIATE);
    added = false;
    if (const std::optional<AnalysisLock> known = findLock(*db, lock.protocolSha256)) return *known;
    AnalysisLock fresh = lock;
    fresh.lockedUtc = nowUtc();
    InsertOf(*db, analysisLockTable())(fresh);
    audit(*db, "analysis-lock", fresh.protocol, fmt::format("values {} (by {})", fresh.valuesSha256, fresh.by));
    transaction.commit();
    added = true;
    return fresh;
  });
}

}  // namespace calot::analytics
