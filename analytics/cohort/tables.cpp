// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of participants and of the audit trail.

#include "analytics/cohort/tables.h"
#include "analytics/cohort/row_statements.h"

#include <fmt/format.h>
#include <algorithm>
#include <chrono>

#include "analytics/cohort/connection.h"

namespace calot::analytics::tables {

void audit(SQLite::Database& db, const std::string& action, const std::string& subject, const std::string& detail) {
  SQLite::Statement insert(db, "INSERT INTO audit (at_utc, action, subject, detail) VALUES (?, ?, ?, ?)");
  SQLite::bind(insert, nowUtc(), action, subject, detail);
  insert.exec();
}

void checkPseudonym(const std::string& pseudonym) {
  const auto control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; };
  if (pseudonym.empty() || pseudonym.size() > 64 || pseudonym.front() == ' ' || pseudonym.back() == ' ' ||
      std::any_of(pseudonym.begin(), pseudonym.end(), control)) {
    throw Error(ErrorKind::invalid,
                "participant: a pseudonym has 1 to 64 characters, no control characters and no blank at its ends");
  }
}

namespace {

void checkDate(const std::string& purpose, const std::string& date) {
  const auto digits = [&](std::size_t from, std::size_t n) {
    unsigned v = 0;
    for (std::size_t i = from; i < from + n; ++i) {
      if (date[i] < '0' || date[i] > '9') return -1;
      v = v * 10 + static_cast<unsigned>(date[i] - '0');
    }
    return static_cast<int>(v);
  };
  bool good = date.size() == 10 && date[4] == '-' && date[7] == '-';
  if (good) {
    const int y = digits(0, 4), m = digits(5, 2), d = digits(8, 2);
    good = y > 0 && m > 0 && d > 0 &&
           std::chrono::year_month_day(std::chrono::year(y), std::chrono::month(static_cast<unsigned>(m)),
                                       std::chrono::day(static_cast<unsigned>(d)))
               .ok();
  }
  if (!good)
    throw Error(ErrorKind::invalid, fmt::format("consent {}: \"{}\" is not a date (YYYY-MM-DD)", purpose, date));
}

}  // namespace

void checkDetails(const std::map<std::string, std::string>& experience,
                  const std::map<std::string, std::string>& consent) {
  for (const auto& item : experience) {
    if (item.first.empty()) throw Error(ErrorKind::invalid, "experience: a criterion needs a name (criterion=value)");
  }
  for (const auto& item : consent) {
    if (item.first.empty()) throw Error(ErrorKind::invalid, "consent: a purpose needs a name (purpose:YYYY-MM-DD)");
    checkDate(item.first, item.second);
  }
}

std::int64_t participantId(SQLite::Database& db, const std::string& pseudonym) {
  SQLite::Statement find(db, "SELECT id FROM participant WHERE pseudonym = ?");
  find.bind(1, pseudonym);
  return find.executeStep() ? find.getColumn(0).getInt64() : -1;
}

std::int64_t insertParticipant(SQLite::Database& db, const Participant& p) {
  InsertOf(db, participantTable(), {"created_utc"})(p, {nowUtc()});
  return db.getLastInsertRowid();
}

void writeDetails(SQLite::Database& db, std::int64_t id, const std::map<std::string, std::string>& experience,
                  const std::map<std::string, std::string>& consent) {
  for (const auto& item : experience) {
    SQLite::Statement put(
        db, "INSERT INTO participant_experience VALUES (?, ?, ?) ON CONFLICT DO UPDATE SET value = excluded.value");
    SQLite::bind(put, id, item.first, item.second);
    put.exec();
  }
  for (const auto& item : consent) {
    SQLite::Statement put(
        db, "INSERT INTO consent VALUES (?, ?, ?) ON CONFLICT DO UPDATE SET given_on = excluded.given_on");
    SQLite::bind(put, id, item.first, item.second);
    put.exec();
  }
}

}  // namespace calot::analytics::tables
