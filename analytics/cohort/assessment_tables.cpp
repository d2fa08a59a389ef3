// SPDX-License-Identifier: GPL-3.0-or-later
// Protocols, filled forms and norms.
#include "analytics/cohort/cohort_database.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "analytics/cohort/tables.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {

using namespace tables;

namespace {

/// Adds the form, or finds it. @throws Error (refused) where this version is another text.
std::int64_t formId(SQLite::Database& db, const std::string& path, const StoredDocument& form) {
  const std::int64_t id =
      firstNumber(db, "SELECT id FROM form WHERE name = ? AND version = ?", {form.name, form.version});
  if (id < 0) {
    InsertOf(db, formTable)(form);
    return db.getLastInsertRowid();
  }
  if (firstTexts(db, "SELECT sha256 FROM form WHERE id = ?", {id}).front() != form.sha256) {
    throw Error(ErrorKind::refused, Where{path},
                fmt::format("form {} version {} is there with another wording; a changed form has a higher version",
                            form.name, form.version));
  }
  return id;
}

}  // namespace

RegisteredProtocol CohortDatabase::registerProtocol(const StoredDocument& protocol, const std::string& by,
                                                    bool& added) {
  if (by.empty()) throw Error(ErrorKind::invalid, "protocol: name who registers it");
  return connection_->change([&](SQLite::Database& db) {
    for (const RegisteredProtocol& known : protocols(protocol.name)) {
      const bool stands = known.withdrawnUtc.empty();
      if (known.sha256 == protocol.sha256 && stands) {
        added = false;
        return known;
      }
      if (known.version == protocol.version || (known.version > protocol.version && stands)) {
        throw Error(
            ErrorKind::refused, Where{path()},
            fmt::format("protocol {} version {} was registered on {}{}; a changed protocol has a higher version",
                        known.name, known.version, known.registeredUtc,
                        stands ? " with another text" : " and withdrawn on " + known.withdrawnUtc));
      }
    }
    RegisteredProtocol fresh{protocol, nowUtc(), by};
    InsertOf(db, protocolTable)(fresh);
    audit(db, "protocol-register", fmt::format("{} {}", fresh.name, fresh.version),
          fmt::format("{} (by {})", fresh.sha256, by));
    added = true;
    return fresh;
  });
}

std::vector<RegisteredProtocol> CohortDatabase::protocols(const std::string& name) const {
  return connection_->read([&](SQLite::Database& db) {
    return selectRows(db, protocolTable, "WHERE name = ?1 OR ?1 = '' ORDER BY name, version", {name});
  });
}

void CohortDatabase::withdrawProtocol(const std::string& sha256, const std::string& reason, const std::string& by) {
  if (by.empty() || reason.empty()) throw Error(ErrorKind::invalid, "protocol: name who withdraws it, and why");
  connection_->change([&](SQLite::Database& db) {
    execute(db, "UPDATE protocol SET withdrawn_utc = ? WHERE sha256 = ?", {nowUtc(), sha256});
    audit(db, "protocol-withdraw", sha256, fmt::format("{} (by {})", reason, by));
  });
}

namespace {

/// The rows of a completed form: by a rater about an attempt, or by a participant.
struct RatingRows {
  const char* table;
  const char* where;
  std::vector<Cell> key;
  std::string about;  ///< "attempt UUID"
  std::string by;     ///< " by \"R1\"", or empty
};

/// @throws Error (refused) where there is no such attempt or participant
RatingRows rowsOf(SQLite::Database& db, const std::string& path, std::int64_t form, const Rating& rating) {
  const bool ofAttempt = !rating.attempt.empty();
  const std::int64_t subject = ofAttempt ? attemptId(db, rating.attempt) : participantId(db, rating.participant);
  RatingRows rows{
      ofAttempt ? "rating" : "questionnaire",
      ofAttempt ? "form = ?1 AND attempt = ?2 AND rater = ?3" : "form = ?1 AND participant = ?2",
      {form, subject},
      ofAttempt ? "attempt " + recorder::shown(rating.attempt) : fmt::format("participant \"{}\"", rating.participant),
      ofAttempt ? fmt::format(" by \"{}\"", rating.rater) : ""};
  if (subject < 0) throw Error(ErrorKind::refused, Where{path}, fmt::format("no {}", rows.about));
  if (ofAttempt) rows.key.emplace_back(rating.rater);
  return rows;
}

/// When the form was completed; or nothing.
std::vector<std::string> ratedOn(SQLite::Database& db, const RatingRows& rows) {
  return firstTexts(db, fmt::format("SELECT rated_utc FROM {} WHERE {} LIMIT 1", rows.table, rows.where), rows.key);
}

void removeRows(SQLite::Database& db, const RatingRows& rows) {
  execute(db, fmt::format("DELETE FROM {} WHERE {}", rows.table, rows.where), rows.key);
}

void auditRating(SQLite::Database& db, const char* action, const std::string& form, std::uint32_t version,
                 const Rating& rating) {
  std::string detail = fmt::format("{} {}", form, version);
  if (!rating.attempt.empty()) detail += " by " + rating.rater;
  if (rating.filmSeen) detail += fmt::format(", {:.0f} % of the film seen", 100.0 * *rating.filmSeen);
  audit(db, action, rating.attempt.empty() ? rating.participant : rating.attempt, detail);
}

}  // namespace

void tables::putRating(SQLite::Database& db, const std::string& path, const StoredDocument& form, const Rating& rating,
                       bool replace) {
  checkPseudonym(rating.attempt.empty() ? rating.participant : rating.rater);
  const std::int64_t formRow = formId(db, path, form);
  const RatingRows rows = rowsOf(db, path, formRow, rating);
  if (const std::vector<std::string> before = ratedOn(db, rows); !before.empty()) {
    if (!replace)
      throw Error(ErrorKind::refused, Where{path},
                  fmt::format("{} was rated with {} on {} already{}", rows.about, form.name, before.front(), rows.by),
                  {Remedy::replaceExisting});
    removeRows(db, rows);
  }
  const std::string now = nowUtc();
  const std::int64_t subject = std::get<std::int64_t>(rows.key[1]);
  for (const auto& [item, score] : rating.answers) {
    if (!rating.attempt.empty()) {
      execute(db, "INSERT INTO rating (form, attempt, rater, item, score, rated_utc) VALUES (?, ?, ?, ?, ?, ?)",
              {formRow, subject, rating.rater, item, score, now});
    } else {
      execute(db, "INSERT INTO questionnaire (form, participant, item, score, rated_utc) VALUES (?, ?, ?, ?, ?)",
              {formRow, subject, item, score, now});
    }
  }
  auditRating(db, "rating", form.name, form.version, rating);
}

void CohortDatabase::removeRating(const Rating& rating) {
  connection_->change([&](SQLite::Database& db) {
    const std::int64_t form =
        firstNumber(db, "SELECT id FROM form WHERE name = ? AND version = ?", {rating.form, rating.formVersion});
    const RatingRows rows = rowsOf(db, path(), form, rating);
    if (ratedOn(db, rows).empty())
      throw Error(ErrorKind::refused, Where{path()},
                  fmt::format("{} was not rated with {}{}", rows.about, recorder::shown(rating.form), rows.by));
    removeRows(db, rows);
    auditRating(db, "rating-remove", rating.form, rating.formVersion, rating);
  });
}

void CohortDatabase::storeRating(const StoredDocument& form, const Rating& rating, bool replace) {
  storeRatings({form}, {{0, rating}}, replace);
}

void CohortDatabase::storeRatings(const std::vector<StoredDocument>& forms,
                                  const std::vector<std::pair<std::size_t, Rating>>& ratings, bool replace) {
  connection_->change([&](SQLite::Database& db) {
    for (const auto& [form, rating] : ratings) putRating(db, path(), forms[form], rating, replace);
  });
}

std::vector<Rating> CohortDatabase::ratings() const {
  return connection_->read([](SQLite::Database& db) {
    std::vector<Rating> ratings;
    const auto keyOf = [](const Rating& r) {
      return std::tie(r.form, r.formVersion, r.attempt, r.rater, r.participant);
    };
    eachRow(db,
            "SELECT f.name AS form, f.version AS version, a.uuid AS attempt, r.rater AS rater, '' AS participant, "
            "r.rated_utc, r.item, r.score FROM rating r JOIN form f ON f.id = r.form JOIN attempt a ON a.id = "
            "r.attempt UNION ALL SELECT f.name, f.version, '', '', p.pseudonym, q.rated_utc, q.item, q.score FROM "
            "questionnaire q JOIN form f ON f.id = q.form JOIN participant p ON p.id = q.participant "
            "ORDER BY form, version, attempt, rater, participant",
            {}, [&](SQLite::Statement& row) {
              Rating r{text(row.getColumn(0)), row.getColumn(1).getUInt(), text(row.getColumn(2)),
                       text(row.getColumn(3)), text(row.getColumn(4)),     {},
                       text(row.getColumn(5))};
              if (ratings.empty() || keyOf(ratings.back()) != keyOf(r)) ratings.push_back(std::move(r));
              ratings.back().answers[text(row.getColumn(6))] = row.getColumn(7).getInt();
            });
    return ratings;
  });
}

std::vector<StoredDocument> CohortDatabase::forms() const {
  return connection_->read([](SQLite::Database& db) { return selectRows(db, formTable, "ORDER BY name, version"); });
}

namespace {

/// -1: no entry has its name and version.
std::int64_t normId(SQLite::Database& db, const Norm& norm) {
  return firstNumber(db, "SELECT id FROM norm WHERE name = ? AND version = ?", {norm.name, norm.version});
}

void writeCheckpoints(SQLite::Database& db, std::int64_t id, const Norm& norm) {
  InsertOf put(db, normCheckpointTable, {"norm", "position"});
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
  norm.checkpoints = selectRows(db, normCheckpointTable, "WHERE norm = ? ORDER BY position", {id});
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

std::uint32_t CohortDatabase::storeNorm(const Norm& norm) {
  if (norm.by.empty()) throw Error(ErrorKind::invalid, "norm: name who makes it");
  checkPseudonym(norm.name);
  return connection_->change([&](SQLite::Database& db) {
    Norm made = norm;
    made.version = static_cast<std::uint32_t>(
        firstNumber(db, "SELECT coalesce(max(version), 0) + 1 FROM norm WHERE name = ?", {norm.name}));
    made.membersMade = norm.members.size();
    made.createdUtc = nowUtc();
    InsertOf(db, normTable)(made);
    const std::int64_t id = db.getLastInsertRowid();
    writeCheckpoints(db, id, norm);
    writeMembers(db, path(), id, norm);
    audit(db, "norm-create", fmt::format("{} {}", norm.name, made.version),
          fmt::format("{} members, {} (by {})", norm.members.size(), norm.judgedBy, norm.by));
    return made.version;
  });
}

void CohortDatabase::removeNorm(const std::string& name, std::uint32_t version, const std::string& by) {
  if (by.empty()) throw Error(ErrorKind::invalid, "norm: name who removes it");
  connection_->change([&](SQLite::Database& db) {
    const std::int64_t newest = firstNumber(db, "SELECT max(version) FROM norm WHERE name = ?", {name});
    const std::int64_t id = firstNumber(db, "SELECT id FROM norm WHERE name = ? AND version = ?", {name, version});
    const auto refuse = [&](const char* why) {
      throw Error(ErrorKind::refused, Where{path()},
                  fmt::format("norm \"{}\" version {} {}", recorder::shown(name), version, why));
    };
    if (id < 0) refuse("is not there");
    if (newest != version) refuse("has a newer version");
    if (firstNumber(db, "SELECT count(*) FROM norm_evidence WHERE norm = ?", {id}) > 0)
      refuse("has evidence of its validity, and stays");
    execute(db, "DELETE FROM norm WHERE id = ?", {id});
    audit(db, "norm-remove", fmt::format("{} {}", name, version), fmt::format("(by {})", by));
  });
}

std::vector<Norm> CohortDatabase::norms() const {
  return connection_->read([](SQLite::Database& db) {
    std::vector<Norm> norms = selectRows(db, normTable, "ORDER BY name, version");
    for (Norm& norm : norms) {
      const std::int64_t id = normId(db, norm);
      readCheckpoints(db, id, norm);
      readMembers(db, id, norm);
      norm.evidence = selectRows(db, normEvidenceTable, "WHERE norm = ? ORDER BY id", {id});
    }
    return norms;
  });
}

Norm CohortDatabase::norm(const std::string& name, std::uint32_t version) const {
  std::optional<Norm> found;
  std::string known;
  for (Norm& norm : norms()) {
    known += fmt::format("{}{} {}", known.empty() ? "" : ", ", norm.name, norm.version);
    if (norm.name == name && (version == 0 || norm.version == version)) found = std::move(norm);
  }
  if (found) return std::move(*found);
  throw Error(ErrorKind::refused, Where{path()},
              fmt::format("no norm \"{}\"{} (there are: {})", recorder::shown(name),
                          version == 0 ? "" : fmt::format(" version {}", version), known.empty() ? "none" : known));
}

void CohortDatabase::attachEvidence(const Norm& norm, const NormEvidence& evidence) {
  if (evidence.statement.empty()) throw Error(ErrorKind::invalid, "norm: say what the evidence shows");
  if (evidence.by.empty()) throw Error(ErrorKind::invalid, "norm: name who attaches the evidence");
  connection_->change([&](SQLite::Database& db) {
    const std::int64_t id = normId(db, norm);
    if (id < 0) {
      throw Error(ErrorKind::refused, Where{path()}, fmt::format("no norm \"{}\" version {}", norm.name, norm.version));
    }
    NormEvidence attached = evidence;
    attached.attachedUtc = nowUtc();
    InsertOf(db, normEvidenceTable, {"norm"})(attached, {id});
    audit(db, "norm-evidence", fmt::format("{} {}", norm.name, norm.version),
          fmt::format("{} {} (by {})", evidence.fileName, evidence.sha256, evidence.by));
  });
}

}  // namespace calot::analytics
