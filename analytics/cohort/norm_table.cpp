// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <utility>

#include "analytics/cohort/row_statements.h"
#include "analytics/cohort/tables.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {

using namespace tables;

namespace {

void writeCheckpoints(SQLite::Database& db, std::int64_t id, const Norm& norm) {
  InsertOf put(db, normCheckpointTable(), {"norm", "position"});
  for (std::size_t i = 0; i < norm.checkpoints.size(); ++i)
    put(norm.checkpoints[i], {id, static_cast<std::int64_t>(i)});
}

void writeMembers(SQLite::Database& db, const std::string& path, std::int64_t id, const Norm& norm) {
  SQLite::Statement put(db, "INSERT INTO norm_member VALUES (?, ?, ?)");
  SQLite::Statement value(db, "INSERT INTO norm_value VALUES (?, ?, ?, ?, ?)");
  for (const NormMember& m : norm.members) {
    const std::int64_t attempt = attemptId(db, m.attempt);
    if (attempt < 0) throw Error(ErrorKind::refused, Where{path}, fmt::format("no attempt {}", m.attempt));
    put.reset();
    SQLite::bind(put, id, attempt, m.competent ? 1 : 0);
    put.exec();
    for (std::size_t c = 0; c < m.values.size(); ++c) {
      if (!m.values[c]) continue;
      value.reset();
      SQLite::bind(value, id, attempt, norm.checkpoints[c].checkpoint, norm.checkpoints[c].subject, *m.values[c]);
      value.exec();
    }
  }
}

void readCheckpoints(SQLite::Database& db, std::int64_t id, Norm& norm) {
  norm.checkpoints = selectRows(db, normCheckpointTable(), "WHERE norm = ? ORDER BY position", id);
  const std::vector<ExternalMetric> metrics = readExternalMetrics(db);
  for (NormCheckpoint& c : norm.checkpoints) {
    const auto metric = std::find_if(metrics.begin(), metrics.end(), [&](const ExternalMetric& m) {
      return m.definition.name == c.checkpoint && m.definition.version == c.version;
    });
    if (metric != metrics.end()) c.metric = ExternalMetricRef(*metric);
  }
}

void readMembers(SQLite::Database& db, std::int64_t id, Norm& norm) {
  std::map<std::pair<std::string, std::string>, std::size_t> position;
  for (std::size_t c = 0; c < norm.checkpoints.size(); ++c)
    position[{norm.checkpoints[c].checkpoint, norm.checkpoints[c].subject}] = c;
  SQLite::Statement select(
      db,
      "SELECT a.uuid, m.competent, v.checkpoint, v.subject, v.value FROM norm_member m JOIN attempt "
      "a ON a.id = m.attempt LEFT JOIN norm_value v ON v.norm = m.norm AND v.attempt = m.attempt "
      "WHERE m.norm = ? ORDER BY a.start_utc, a.uuid");
  select.bind(1, id);
  while (select.executeStep()) {
    const std::string attempt = text(select.getColumn(0));
    if (norm.members.empty() || norm.members.back().attempt != attempt) {
      norm.members.push_back(
          {attempt, select.getColumn(1).getInt() != 0, std::vector<std::optional<double>>(norm.checkpoints.size())});
    }
    if (select.getColumn(2).isNull()) continue;
    const auto at = position.find({text(select.getColumn(2)), text(select.getColumn(3))});
    if (at != position.end()) norm.members.back().values[at->second] = select.getColumn(4).getDouble();
  }
}

}  // namespace

std::uint32_t AssessmentDatabase::storeNorm(const Norm& norm) {
  if (norm.by.empty()) throw Error(ErrorKind::invalid, "norm: name who makes it");
  checkPseudonym(norm.name);
  return guarded(storage_->path, [&] {
    SQLite::Database& db = *storage_->db;
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    SQLite::Statement newest(db, "SELECT coalesce(max(version), 0) FROM norm WHERE name = ?");
    newest.bind(1, norm.name);
    newest.executeStep();
    const std::uint32_t version = newest.getColumn(0).getUInt() + 1;
    newest.reset();
    Norm made = norm;
    made.version = version;
    made.membersMade = norm.members.size();
    made.createdUtc = nowUtc();
    InsertOf(db, normTable())(made);
    const std::int64_t id = db.getLastInsertRowid();
    writeCheckpoints(db, id, norm);
    writeMembers(db, storage_->path, id, norm);
    audit(db, "norm-create", fmt::format("{} {}", norm.name, version),
          fmt::format("{} members, {} (by {})", norm.members.size(), norm.judgedBy, norm.by));
    transaction.commit();
    return version;
  });
}

std::vector<Norm> AssessmentDatabase::norms() const {
  return guarded(storage_->path, [&] {
    SQLite::Database& db = *storage_->db;
    SQLite::Statement select(db,
                             fmt::format("SELECT id, {} FROM norm ORDER BY name, version", memberColumns(normTable())));
    std::vector<Norm> norms;
    while (select.executeStep()) {
      const std::int64_t id = select.getColumn(0).getInt64();
      Norm norm;
      int c = 1;
      readMembers(normTable(), select, c, norm);
      readCheckpoints(db, id, norm);
      readMembers(db, id, norm);
      norm.evidence = selectRows(db, normEvidenceTable(), "WHERE norm = ? ORDER BY id", id);
      norms.push_back(std::move(norm));
    }
    return norms;
  });
}

Norm AssessmentDatabase::norm(const std::string& name, std::uint32_t version) const {
  std::optional<Norm> found;
  std::string known;
  for (Norm& norm : norms()) {
    known += fmt::format("{}{} {}", known.empty() ? "" : ", ", norm.name, norm.version);
    if (norm.name == name && (version == 0 || norm.version == version)) found = std::move(norm);
  }
  if (found) return std::move(*found);
  throw Error(ErrorKind::refused, Where{storage_->path},
              fmt::format("no norm \"{}\"{} (there are: {})", recorder::shown(name),
                          version == 0 ? "" : fmt::format(" version {}", version), known.empty() ? "none" : known));
}

void AssessmentDatabase::attachEvidence(const Norm& norm, const NormEvidence& evidence) {
  if (evidence.statement.empty()) throw Error(ErrorKind::invalid, "norm: say what the evidence shows");
  if (evidence.by.empty()) throw Error(ErrorKind::invalid, "norm: name who attaches the evidence");
  guarded(storage_->path, [&] {
    SQLite::Database& db = *storage_->db;
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    SQLite::Statement find(db, "SELECT id FROM norm WHERE name = ? AND version = ?");
    SQLite::bind(find, norm.name, norm.version);
    if (!find.executeStep())
      throw Error(ErrorKind::refused, Where{storage_->path},
                  fmt::format("no norm \"{}\" version {}", norm.name, norm.version));
    NormEvidence attached = evidence;
    attached.attachedUtc = nowUtc();
    InsertOf(db, normEvidenceTable(), {"norm"})(attached, {find.getColumn(0).getInt64()});
    audit(db, "norm-evidence", fmt::format("{} {}", norm.name, norm.version),
          fmt::format("{} {} (by {})", evidence.fileName, evidence.sha256, evidence.by));
    transaction.commit();
  });
}

}  // namespace calot::analytics
