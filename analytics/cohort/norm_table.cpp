// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "analytics/cohort/tables.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {

using namespace tables;

namespace {

/// -1: no entry has its name and version.
std::int64_t normId(SQLite::Database& db, const Norm& norm) {
  return firstNumber(db, "SELECT id FROM norm WHERE name = ? AND version = ?", {norm.name, norm.version});
}

void writeCheckpoints(SQLite::Database& db, std::int64_t id, const Norm& norm) {
  InsertOf put(db, normCheckpointTable(), {"norm", "position"});
  for (std::size_t i = 0; i < norm.checkpoints.size(); ++i)
    put(norm.checkpoints[i], {id, static_cast<std::int64_t>(i)});
}

void writeMembers(SQLite::Database& db, const std::string& path, std::int64_t id, const Norm& norm) {
  for (const NormMember& m : norm.members) {
    const std::int64_t attempt = knownAttempt(db, path, m.attempt);
    execute(db, "INSERT INTO norm_member VALUES (?, ?, ?)", {id, attempt, m.competent ? 1 : 0});
    for (std::size_t c = 0; c < m.values.size(); ++c) {
      if (!m.values[c]) continue;
      execute(db, "INSERT INTO norm_value VALUES (?, ?, ?, ?, ?)",
              {id, attempt, norm.checkpoints[c].checkpoint, norm.checkpoints[c].subject, *m.values[c]});
    }
  }
}

void readCheckpoints(SQLite::Database& db, std::int64_t id, Norm& norm) {
  norm.checkpoints = selectRows(db, normCheckpointTable(), "WHERE norm = ? ORDER BY position", {id});
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
  eachRow(db,
          "SELECT a.uuid, m.competent, v.checkpoint, v.subject, v.value FROM norm_member m JOIN attempt a ON a.id = "
          "m.attempt LEFT JOIN norm_value v ON v.norm = m.norm AND v.attempt = m.attempt WHERE m.norm = ? "
          "ORDER BY a.start_utc, a.uuid",
          {id}, [&](SQLite::Statement& row) {
            const std::string attempt = text(row.getColumn(0));
            if (norm.members.empty() || norm.members.back().attempt != attempt) {
              norm.members.push_back({attempt, row.getColumn(1).getInt() != 0,
                                      std::vector<std::optional<double>>(norm.checkpoints.size())});
            }
            const auto at = position.find({text(row.getColumn(2)), text(row.getColumn(3))});
            if (at != position.end()) norm.members.back().values[at->second] = row.getColumn(4).getDouble();
          });
}

}  // namespace

std::uint32_t AssessmentDatabase::storeNorm(const Norm& norm) {
  if (norm.by.empty()) throw Error(ErrorKind::invalid, "norm: name who makes it");
  checkPseudonym(norm.name);
  return connection_->change([&](SQLite::Database& db) {
    Norm made = norm;
    made.version = static_cast<std::uint32_t>(
        firstNumber(db, "SELECT coalesce(max(version), 0) + 1 FROM norm WHERE name = ?", {norm.name}));
    made.membersMade = norm.members.size();
    made.createdUtc = nowUtc();
    InsertOf(db, normTable())(made);
    const std::int64_t id = db.getLastInsertRowid();
    writeCheckpoints(db, id, norm);
    writeMembers(db, connection_->path, id, norm);
    audit(db, "norm-create", fmt::format("{} {}", norm.name, made.version),
          fmt::format("{} members, {} (by {})", norm.members.size(), norm.judgedBy, norm.by));
    return made.version;
  });
}

std::vector<Norm> AssessmentDatabase::norms() const {
  return connection_->read([](SQLite::Database& db) {
    std::vector<Norm> norms = selectRows(db, normTable(), "ORDER BY name, version");
    for (Norm& norm : norms) {
      const std::int64_t id = normId(db, norm);
      readCheckpoints(db, id, norm);
      readMembers(db, id, norm);
      norm.evidence = selectRows(db, normEvidenceTable(), "WHERE norm = ? ORDER BY id", {id});
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
  throw Error(ErrorKind::refused, Where{connection_->path},
              fmt::format("no norm \"{}\"{} (there are: {})", recorder::shown(name),
                          version == 0 ? "" : fmt::format(" version {}", version), known.empty() ? "none" : known));
}

void AssessmentDatabase::attachEvidence(const Norm& norm, const NormEvidence& evidence) {
  if (evidence.statement.empty()) throw Error(ErrorKind::invalid, "norm: say what the evidence shows");
  if (evidence.by.empty()) throw Error(ErrorKind::invalid, "norm: name who attaches the evidence");
  connection_->change([&](SQLite::Database& db) {
    const std::int64_t id = normId(db, norm);
    if (id < 0) {
      throw Error(ErrorKind::refused, Where{connection_->path},
                  fmt::format("no norm \"{}\" version {}", norm.name, norm.version));
    }
    NormEvidence attached = evidence;
    attached.attachedUtc = nowUtc();
    InsertOf(db, normEvidenceTable(), {"norm"})(attached, {id});
    audit(db, "norm-evidence", fmt::format("{} {}", norm.name, norm.version),
          fmt::format("{} {} (by {})", evidence.fileName, evidence.sha256, evidence.by));
  });
}

}  // namespace calot::analytics
