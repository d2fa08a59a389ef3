// SPDX-License-Identifier: GPL-3.0-or-later
// Data that a withdrawal would remove, and the register of exports.
#include <fmt/format.h>

#include <filesystem>
#include <set>
#include <system_error>
#include <tuple>

#include "analytics/cohort/connection.h"
#include "analytics/cohort/tables.h"
#include "analytics/cohort/withdraw.h"

namespace calot::analytics {
namespace {

using namespace tables;

constexpr auto planPatience = std::chrono::seconds(10);

/// Attempts that branch from one of these, from those, and so on, behind them.
void addBranches(SQLite::Database& db, std::vector<std::string>& uuids) {
  std::set<std::string> known(uuids.begin(), uuids.end());
  SQLite::Statement find(db, "SELECT uuid FROM attempt WHERE parent_uuid = ? ORDER BY uuid");
  for (std::size_t i = 0; i < uuids.size(); ++i) {
    find.reset();
    find.bind(1, uuids[i]);
    while (find.executeStep()) {
      std::string uuid = find.getColumn(0).getString();
      if (known.insert(uuid).second) uuids.push_back(std::move(uuid));
    }
  }
}

}  // namespace

void recordExport(const std::string& path, const std::string& kind, const std::string& target,
                  const std::vector<std::string>& attempts) {
  guarded(path, [&] {
    const auto handle = openCohort(path, CohortDatabase::Access::write, planPatience);
    SQLite::Database& db = *handle;
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    std::error_code ignored;
    const std::string place = std::filesystem::absolute(target, ignored).lexically_normal().string();
    SQLite::Statement put(db, "INSERT INTO export (at_utc, kind, target) VALUES (?, ?, ?)");
    SQLite::bind(put, nowUtc(), kind, place);
    put.exec();
    const std::int64_t id = db.getLastInsertRowid();
    SQLite::Statement link(db, "INSERT INTO export_attempt VALUES (?, ?) ON CONFLICT DO NOTHING");
    for (const std::string& uuid : attempts) {
      const std::int64_t attempt = attemptId(db, uuid);
      if (attempt < 0) throw Error(ErrorKind::refused, Where{path}, fmt::format("no attempt {}", uuid));
      link.reset();
      SQLite::bind(link, id, attempt);
      link.exec();
    }
    transaction.commit();
  });
}

Withdrawal planWithdrawal(const std::string& path, const std::string& pseudonym, WithdrawalScope scope) {
  return guarded(path, [&] {
    const auto handle = openCohort(path, CohortDatabase::Access::write, planPatience);
    SQLite::Database& db = *handle;
    Withdrawal w;
    w.pseudonym = pseudonym;
    w.scope = scope;
    const std::int64_t id = participantId(db, pseudonym);
    w.known = id >= 0;
    if (!w.known) return w;
    SQLite::Statement own(db,
                          "SELECT uuid FROM attempt WHERE participant = ? AND (? OR purpose <> 'training') "
                          "ORDER BY uuid");
    SQLite::bind(own, id, scope == WithdrawalScope::all ? 1 : 0);
    while (own.executeStep()) w.attempts.push_back(own.getColumn(0).getString());
    addBranches(db, w.attempts);
    std::set<ExportRow, bool (*)(const ExportRow&, const ExportRow&)> exports(
        [](const ExportRow& a, const ExportRow& b) {
          return std::tie(a.utc, a.kind, a.target) < std::tie(b.utc, b.kind, b.target);
        });
    SQLite::Statement whose(db, "SELECT coalesce(participant, -1) FROM attempt WHERE uuid = ?");
    SQLite::Statement held(db,
                           "SELECT e.at_utc, e.kind, e.target FROM export e JOIN export_attempt x ON x.export = e.id "
                           "JOIN attempt a ON a.id = x.attempt WHERE a.uuid = ?");
    for (const std::string& uuid : w.attempts) {
      whose.reset();
      whose.bind(1, uuid);
      if (whose.executeStep() && whose.getColumn(0).getInt64() != id && whose.getColumn(0).getInt64() >= 0)
        w.branchesOfOthers.push_back(uuid);
      held.reset();
      held.bind(1, uuid);
      while (held.executeStep())
        exports.insert({text(held.getColumn(0)), text(held.getColumn(1)), text(held.getColumn(2))});
    }
    w.exports.assign(exports.begin(), exports.end());
    return w;
  });
}

}  // namespace calot::analytics
