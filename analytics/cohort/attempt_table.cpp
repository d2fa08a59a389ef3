// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <map>
#include <utility>

#include "analytics/cohort/tables.h"

namespace calot::analytics::tables {
namespace {

constexpr const char* attemptColumns =
    "SELECT a.uuid, a.parent_uuid, coalesce(p.pseudonym, ''), a.scene, a.scene_major, a.scene_minor, a.operator_kind, "
    "a.profile, a.profile_version, a.mode, a.purpose, a.outcome, a.start_utc, a.seed, a.device, a.calibration, "
    "a.simulation_version, a.comparability_key, a.synthetic, r.file_name, r.complete, r.steps, r.step_seconds, "
    "r.chain_head, "
    "v.verdict, v.detail, v.software, v.verified_utc, coalesce(p.study_group, ''), coalesce(p.arm, ''), "
    "coalesce(p.site, ''), "
    "a.imported_utc, a.station, s.public_key, s.signature, w.participant, e.reason, e.excluded_by "
    "FROM attempt a JOIN recording r ON r.attempt = a.id "
    "LEFT JOIN verification v ON v.attempt = a.id LEFT JOIN participant p ON p.id = a.participant "
    "LEFT JOIN exclusion e ON e.attempt = a.id LEFT JOIN recording_signature s ON s.attempt = a.id "
    "LEFT JOIN research_withdrawal w ON w.participant = a.participant ";

template <std::size_t N>
void copyBlob(const SQLite::Column& column, std::array<std::byte, N>& to) {
  std::memcpy(to.data(), column.getBlob(), std::min<std::size_t>(N, static_cast<std::size_t>(column.getBytes())));
}

AttemptRow attemptRow(SQLite::Statement& row) {
  AttemptRow a;
  int c = 0;
  a.uuid = text(row.getColumn(c++));
  a.parent = text(row.getColumn(c++));
  a.participant = text(row.getColumn(c++));
  a.scene = text(row.getColumn(c++));
  a.sceneMajor = row.getColumn(c++).getUInt();
  a.sceneMinor = row.getColumn(c++).getUInt();
  a.operatorKind = enumeration<recorder::OperatorKind>(row.getColumn(c++));
  a.profile = text(row.getColumn(c++));
  a.profileVersion = text(row.getColumn(c++));
  a.mode = enumeration<recorder::Mode>(row.getColumn(c++));
  a.purpose = text(row.getColumn(c++));
  a.outcome = enumeration<recorder::Outcome>(row.getColumn(c++));
  a.startUtc = text(row.getColumn(c++));
  a.seed = std::strtoull(text(row.getColumn(c++)).c_str(), nullptr, 10);
  a.device = text(row.getColumn(c++));
  a.calibration = text(row.getColumn(c++));
  a.simulationVersion = row.getColumn(c++).getUInt();
  a.comparabilityKey = text(row.getColumn(c++));
  a.synthetic = row.getColumn(c++).getInt() != 0;
  a.fileName = text(row.getColumn(c++));
  a.complete = row.getColumn(c++).getInt() != 0;
  a.steps = static_cast<std::uint64_t>(row.getColumn(c++).getInt64());
  a.stepSeconds = row.getColumn(c++).getDouble();
  copyBlob(row.getColumn(c++), a.chainHead);
  const SQLite::Column verdict = row.getColumn(c++);
  a.verification.verdict = verdict.isNull() ? Verdict::notChecked : enumeration<Verdict>(verdict);
  a.verification.text = text(row.getColumn(c++));
  a.verification.software = text(row.getColumn(c++));
  a.verifiedUtc = text(row.getColumn(c++));
  a.group = text(row.getColumn(c++));
  a.arm = text(row.getColumn(c++));
  a.site = text(row.getColumn(c++));
  a.importedUtc = text(row.getColumn(c++));
  a.station = text(row.getColumn(c++));
  if (!row.getColumn(c).isNull()) {
    a.signature.emplace();
    copyBlob(row.getColumn(c), a.signature->publicKey);
    copyBlob(row.getColumn(c + 1), a.signature->value);
  }
  c += 2;
  a.withdrawn = !row.getColumn(c++).isNull();
  const SQLite::Column reason = row.getColumn(c++);
  a.excluded = a.withdrawn || !reason.isNull();
  if (a.withdrawn) {
    a.exclusionReason = "withdrawn from research";
  } else if (a.excluded) {
    a.exclusionReason = fmt::format("{} ({})", text(reason), text(row.getColumn(c)));
  }
  return a;
}

}  // namespace

std::int64_t attemptId(SQLite::Database& db, const std::string& uuid) {
  SQLite::Statement find(db, "SELECT id FROM attempt WHERE uuid = ?");
  find.bind(1, uuid);
  return find.executeStep() ? find.getColumn(0).getInt64() : -1;
}

std::optional<AttemptRow> findAttempt(SQLite::Database& db, const std::string& uuid) {
  SQLite::Statement select(db, std::string(attemptColumns) + "WHERE a.uuid = ?");
  select.bind(1, uuid);
  if (!select.executeStep()) return std::nullopt;
  AttemptRow row = attemptRow(select);
  SQLite::Statement tags(db, "SELECT tag FROM attempt_tag WHERE attempt = ? ORDER BY tag");
  tags.bind(1, attemptId(db, uuid));
  while (tags.executeStep()) row.tags.push_back(text(tags.getColumn(0)));
  return row;
}

std::vector<AttemptRow> readAttempts(SQLite::Database& db) {
  SQLite::Statement select(db, std::string(attemptColumns) + "ORDER BY a.start_utc, a.uuid");
  std::vector<AttemptRow> rows;
  while (select.executeStep()) rows.push_back(attemptRow(select));
  // Few have any: looking for them beside each attempt would cost more.
  std::map<std::string, std::vector<std::string>> tagsOf;
  SQLite::Statement tags(db, "SELECT a.uuid, t.tag FROM attempt_tag t JOIN attempt a ON a.id = t.attempt ORDER BY 2");
  while (tags.executeStep()) tagsOf[text(tags.getColumn(0))].push_back(text(tags.getColumn(1)));
  if (tagsOf.empty()) return rows;
  for (AttemptRow& row : rows) {
    if (const auto at = tagsOf.find(row.uuid); at != tagsOf.end()) row.tags = std::move(at->second);
  }
  return rows;
}

}  // namespace calot::analytics::tables
