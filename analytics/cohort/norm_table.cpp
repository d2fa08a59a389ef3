// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <utility>

#include "analytics/cohort/tables.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {

using namespace tables;

namespace {

void writeCheckpoints(SQLite::Database& db, std::int64_t id, const Norm& norm) {
  SQLite::Statement put(db, "INSERT INTO norm_checkpoint VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  for (std::size_t i = 0; i < norm.checkpoints.size(); ++i) {
    const NormCheckpoint& c = norm.checkpoints[i];
    put.reset();
    put.clearBindings();
    put.bind(1, id);
    put.bind(2, static_cast<std::int64_t>(i));
    put.bind(3, c.checkpoint);
    put.bind(4, c.subject);
    put.bind(5, c.version);
    put.bind(6, number(c.direction));
    put.bind(7, c.logScale ? 1 : 0);
    put.bind(8, c.inRule ? 1 : 0);
    bindOptional(put, 9, c.cut);
    bindOptional(put, 10, c.lower);
    bindOptional(put, 11, c.upper);
    put.bind(12, c.reason);
    put.exec();
  }
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
  SQLite::Statement select(db,
                           "SELECT checkpoint, subject, version, direction, log_scale, in_rule, cut, lower, upper, "
                           "reason FROM norm_checkpoint WHERE norm = ? ORDER BY position");
  select.bind(1, id);
  const std::vector<ExternalMetric> metrics = readExternalMetrics(db);
  while (select.executeStep()) {
    NormCheckpoint& c = norm.checkpoints.emplace_back();
    c.checkpoint = text(select.getColumn(0));
    c.subject = text(select.getColumn(1));
    c.version = select.getColumn(2).getUInt();
    c.direction = enumeration<Direction>(select.getColumn(3));
    c.logScale = select.getColumn(4).getInt() != 0;
    c.inRule = select.getColumn(5).getInt() != 0;
    c.cut = optional(select.getColumn(6));
    c.lower = optional(select.getColumn(7));
    c.upper = optional(select.getColumn(8));
    c.reason = text(select.getColumn(9));
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

void readEvidence(SQLite::Database& db, std::int64_t id, Norm& norm) {
  SQLite::Statement select(db,
                           "SELECT statement, file_name, sha256, attached_by, attached_utc FROM norm_evidence WHERE "
                           "norm = ? ORDER BY id");
  select.bind(1, id);
  while (select.executeStep()) {
    norm.evidence.push_back({text(select.getColumn(0)), text(select.getColumn(1)), text(select.getColumn(2)),
                             text(select.getColumn(3)), text(select.getColumn(4))});
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
    SQLite::Statement put(db,
                          "INSERT INTO norm (name, version, comparability_key, judged_by, least_passed, members, "
                          "synthetic, seed, created_utc, created_by) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
    SQLite::bind(put, norm.name, version, norm.comparabilityKey, norm.judgedBy, norm.leastPassed,
                 static_cast<std::int64_t>(norm.members.size()), norm.synthetic ? 1 : 0, fmt::format("{}", norm.seed),
                 nowUtc(), norm.by);
    put.exec();
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
                             "SELECT id, name, version, comparability_key, judged_by, least_passed, members, "
                             "synthetic, seed, created_utc, created_by FROM norm ORDER BY name, version");
    std::vector<Norm> norms;
    while (select.executeStep()) {
      const std::int64_t id = select.getColumn(0).getInt64();
      Norm norm;
      norm.name = text(select.getColumn(1));
      norm.version = select.getColumn(2).getUInt();
      norm.comparabilityKey = text(select.getColumn(3));
      norm.judgedBy = text(select.getColumn(4));
      norm.leastPassed = select.getColumn(5).getUInt();
      norm.membersMade = static_cast<std::uint64_t>(select.getColumn(6).getInt64());
      norm.synthetic = select.getColumn(7).getInt() != 0;
      norm.seed = std::strtoull(text(select.getColumn(8)).c_str(), nullptr, 10);
      norm.createdUtc = text(select.getColumn(9));
      norm.by = text(select.getColumn(10));
      readCheckpoints(db, id, norm);
      readMembers(db, id, norm);
      readEvidence(db, id, norm);
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
    SQLite::Statement put(db,
                          "INSERT INTO norm_evidence (norm, statement, file_name, sha256, attached_by, attached_utc) "
                          "VALUES (?, ?, ?, ?, ?, ?)");
    SQLite::bind(put, find.getColumn(0).getInt64(), evidence.statement, evidence.fileName, evidence.sha256, evidence.by,
                 nowUtc());
    put.exec();
    audit(db, "norm-evidence", fmt::format("{} {}", norm.name, norm.version),
          fmt::format("{} {} (by {})", evidence.fileName, evidence.sha256, evidence.by));
    transaction.commit();
  });
}

}  // namespace calot::analytics
