// SPDX-License-Identifier: GPL-3.0-or-later
// Protocols and filled forms; norms are in norm_table.cpp.
#include "analytics/cohort/assessment_database.h"

#include <fmt/format.h>

#include "analytics/cohort/row_statements.h"
#include "analytics/cohort/tables.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {

using namespace tables;

namespace {

/// Adds the form, or finds it. @throws Error (refused) where this version is another text.
std::int64_t formId(SQLite::Database& db, const std::string& path, const StoredDocument& form) {
  SQLite::Statement find(db, "SELECT id, sha256 FROM form WHERE name = ? AND version = ?");
  SQLite::bind(find, form.name, form.version);
  if (find.executeStep()) {
    if (text(find.getColumn(1)) != form.sha256) {
      throw Error(ErrorKind::refused, Where{path},
                  fmt::format("form {} version {} is there with another wording; a changed form has a higher version",
                              form.name, form.version));
    }
    return find.getColumn(0).getInt64();
  }
  InsertOf(db, formTable())(form);
  return db.getLastInsertRowid();
}

}  // namespace

AssessmentDatabase::AssessmentDatabase(const std::string& path, CohortDatabase::Access access,
                                       std::chrono::milliseconds patience)
    : storage_(std::make_unique<Storage>()) {
  storage_->path = path;
  storage_->db = openCohort(path, access, patience);
}

AssessmentDatabase::~AssessmentDatabase() = default;

RegisteredProtocol AssessmentDatabase::registerProtocol(const StoredDocument& protocol, const std::string& by,
                                                        bool& added) {
  if (by.empty()) throw Error(ErrorKind::invalid, "protocol: name who registers it");
  return guarded(storage_->path, [&] {
    SQLite::Database& db = *storage_->db;
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    for (const RegisteredProtocol& known : protocols(protocol.name)) {
      if (known.sha256 == protocol.sha256) {
        added = false;
        return known;
      }
      if (known.version >= protocol.version) {
        throw Error(ErrorKind::refused, Where{storage_->path},
                    fmt::format("protocol {} version {} was registered on {} with another text; a changed protocol has "
                                "a higher version",
                                known.name, known.version, known.registeredUtc));
      }
    }
    RegisteredProtocol fresh{protocol, nowUtc(), by};
    InsertOf(db, protocolTable())(fresh);
    audit(db, "protocol-register", fmt::format("{} {}", fresh.name, fresh.version),
          fmt::format("{} (by {})", fresh.sha256, by));
    transaction.commit();
    added = true;
    return fresh;
  });
}

std::vector<RegisteredProtocol> AssessmentDatabase::protocols(const std::string& name) const {
  return guarded(storage_->path, [&] {
    return selectRows(*storage_->db, protocolTable(), "WHERE name = ?1 OR ?1 = '' ORDER BY name, version", name);
  });
}

void tables::putRating(SQLite::Database& db, const std::string& path, const StoredDocument& form, const Rating& rating,
                       bool replace) {
  checkPseudonym(rating.attempt.empty() ? rating.participant : rating.rater);
  const std::int64_t formRow = formId(db, path, form);
  const bool ofAttempt = !rating.attempt.empty();
  const std::int64_t subject = ofAttempt ? attemptId(db, rating.attempt) : participantId(db, rating.participant);
  const std::string about =
      ofAttempt ? "attempt " + recorder::shown(rating.attempt) : fmt::format("participant \"{}\"", rating.participant);
  if (subject < 0) throw Error(ErrorKind::refused, Where{path}, fmt::format("no {}", about));
  const char* table = ofAttempt ? "rating" : "questionnaire";
  const char* whose = ofAttempt ? "form = ?1 AND attempt = ?2 AND rater = ?3" : "form = ?1 AND participant = ?2";
  const auto bind = [&](SQLite::Statement& statement) {
    statement.bind(1, formRow);
    statement.bind(2, subject);
    if (ofAttempt) statement.bind(3, rating.rater);
  };
  SQLite::Statement find(db, fmt::format("SELECT rated_utc FROM {} WHERE {} LIMIT 1", table, whose));
  bind(find);
  if (find.executeStep()) {
    if (!replace) {
      throw Error(ErrorKind::refused, Where{path},
                  fmt::format("{} was rated with {} on {} already{}", about, form.name, text(find.getColumn(0)),
                              ofAttempt ? fmt::format(" by \"{}\"", rating.rater) : ""),
                  {Remedy::replaceExisting});
    }
    find.reset();
    SQLite::Statement clear(db, fmt::format("DELETE FROM {} WHERE {}", table, whose));
    bind(clear);
    clear.exec();
  }
  const std::string now = nowUtc();
  SQLite::Statement put(
      db, ofAttempt
              ? "INSERT INTO rating (form, attempt, rater, item, score, rated_utc) VALUES (?1, ?2, ?3, ?4, ?5, ?6)"
              : "INSERT INTO questionnaire (form, participant, item, score, rated_utc) VALUES (?1, ?2, ?4, ?5, "
                "?6)");
  for (const auto& [item, score] : rating.answers) {
    put.reset();
    bind(put);
    put.bind(4, item);
    put.bind(5, score);
    put.bind(6, now);
    put.exec();
  }
  audit(db, "rating", ofAttempt ? rating.attempt : rating.participant,
        fmt::format("{} {}{}", form.name, form.version, ofAttempt ? " by " + rating.rater : ""));
}

void AssessmentDatabase::storeRating(const StoredDocument& form, const Rating& rating, bool replace) {
  storeRatings({form}, {{0, rating}}, replace);
}

void AssessmentDatabase::storeRatings(const std::vector<StoredDocument>& forms,
                                      const std::vector<std::pair<std::size_t, Rating>>& ratings, bool replace) {
  guarded(storage_->path, [&] {
    SQLite::Database& db = *storage_->db;
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    for (const auto& [form, rating] : ratings) putRating(db, storage_->path, forms[form], rating, replace);
    transaction.commit();
  });
}

std::vector<Rating> AssessmentDatabase::ratings() const {
  return guarded(storage_->path, [&] {
    SQLite::Statement select(
        *storage_->db,
        "SELECT f.name AS form, f.version AS version, a.uuid AS attempt, r.rater AS rater, '' AS participant, "
        "r.rated_utc, r.item, r.score FROM rating r JOIN form f ON f.id = r.form JOIN attempt a ON a.id = r.attempt "
        "UNION ALL SELECT f.name, f.version, '', '', p.pseudonym, q.rated_utc, q.item, q.score FROM questionnaire q "
        "JOIN form f ON f.id = q.form JOIN participant p ON p.id = q.participant "
        "ORDER BY form, version, attempt, rater, participant");
    std::vector<Rating> ratings;
    while (select.executeStep()) {
      Rating r{text(select.getColumn(0)), select.getColumn(1).getUInt(), text(select.getColumn(2)),
               text(select.getColumn(3)), text(select.getColumn(4)),     {},
               text(select.getColumn(5))};
      const bool same = !ratings.empty() && ratings.back().form == r.form &&
                        ratings.back().formVersion == r.formVersion && ratings.back().attempt == r.attempt &&
                        ratings.back().rater == r.rater && ratings.back().participant == r.participant;
      if (!same) ratings.push_back(std::move(r));
      ratings.back().answers[text(select.getColumn(6))] = select.getColumn(7).getInt();
    }
    return ratings;
  });
}

std::vector<StoredDocument> AssessmentDatabase::forms() const {
  return guarded(storage_->path, [&] { return selectRows(*storage_->db, formTable(), "ORDER BY name, version"); });
}

}  // namespace calot::analytics
