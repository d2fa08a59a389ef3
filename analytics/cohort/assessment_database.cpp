// SPDX-License-Identifier: GPL-3.0-or-later
// Protocols and filled forms; norms are in norm_table.cpp.
#include "analytics/cohort/assessment_database.h"

#include <fmt/format.h>

#include <tuple>

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
    InsertOf(db, formTable())(form);
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

AssessmentDatabase::AssessmentDatabase(const std::string& path, CohortDatabase::Access access,
                                       std::chrono::milliseconds patience)
    : connection_(std::make_unique<CohortConnection>(path, access, patience)) {}

AssessmentDatabase::~AssessmentDatabase() = default;

RegisteredProtocol AssessmentDatabase::registerProtocol(const StoredDocument& protocol, const std::string& by,
                                                        bool& added) {
  if (by.empty()) throw Error(ErrorKind::invalid, "protocol: name who registers it");
  return connection_->change([&](SQLite::Database& db) {
    for (const RegisteredProtocol& known : protocols(protocol.name)) {
      if (known.sha256 == protocol.sha256) {
        added = false;
        return known;
      }
      if (known.version >= protocol.version) {
        throw Error(ErrorKind::refused, Where{connection_->path},
                    fmt::format("protocol {} version {} was registered on {} with another text; a changed protocol has "
                                "a higher version",
                                known.name, known.version, known.registeredUtc));
      }
    }
    RegisteredProtocol fresh{protocol, nowUtc(), by};
    InsertOf(db, protocolTable())(fresh);
    audit(db, "protocol-register", fmt::format("{} {}", fresh.name, fresh.version),
          fmt::format("{} (by {})", fresh.sha256, by));
    added = true;
    return fresh;
  });
}

std::vector<RegisteredProtocol> AssessmentDatabase::protocols(const std::string& name) const {
  return connection_->read([&](SQLite::Database& db) {
    return selectRows(db, protocolTable(), "WHERE name = ?1 OR ?1 = '' ORDER BY name, version", {name});
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
  std::vector<Cell> key{formRow, subject};
  if (ofAttempt) key.emplace_back(rating.rater);
  const std::vector<std::string> before =
      firstTexts(db, fmt::format("SELECT rated_utc FROM {} WHERE {} LIMIT 1", table, whose), key);
  if (!before.empty()) {
    if (!replace) {
      throw Error(ErrorKind::refused, Where{path},
                  fmt::format("{} was rated with {} on {} already{}", about, form.name, before.front(),
                              ofAttempt ? fmt::format(" by \"{}\"", rating.rater) : ""),
                  {Remedy::replaceExisting});
    }
    execute(db, fmt::format("DELETE FROM {} WHERE {}", table, whose), key);
  }
  const std::string now = nowUtc();
  for (const auto& [item, score] : rating.answers) {
    if (ofAttempt) {
      execute(db, "INSERT INTO rating (form, attempt, rater, item, score, rated_utc) VALUES (?, ?, ?, ?, ?, ?)",
              {formRow, subject, rating.rater, item, score, now});
    } else {
      execute(db, "INSERT INTO questionnaire (form, participant, item, score, rated_utc) VALUES (?, ?, ?, ?, ?)",
              {formRow, subject, item, score, now});
    }
  }
  audit(db, "rating", ofAttempt ? rating.attempt : rating.participant,
        fmt::format("{} {}{}", form.name, form.version, ofAttempt ? " by " + rating.rater : ""));
}

void AssessmentDatabase::storeRating(const StoredDocument& form, const Rating& rating, bool replace) {
  storeRatings({form}, {{0, rating}}, replace);
}

void AssessmentDatabase::storeRatings(const std::vector<StoredDocument>& forms,
                                      const std::vector<std::pair<std::size_t, Rating>>& ratings, bool replace) {
  connection_->change([&](SQLite::Database& db) {
    for (const auto& [form, rating] : ratings) putRating(db, connection_->path, forms[form], rating, replace);
  });
}

std::vector<Rating> AssessmentDatabase::ratings() const {
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

std::vector<StoredDocument> AssessmentDatabase::forms() const {
  return connection_->read([](SQLite::Database& db) { return selectRows(db, formTable(), "ORDER BY name, version"); });
}

}  // namespace calot::analytics
