// SPDX-License-Identifier: GPL-3.0-or-later
// Access to single tables, which CohortDatabase and AssessmentDatabase combine. No function here begins a transaction.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>
#include <SQLiteCpp/VariadicBind.h>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analytics/cohort/assessment_database.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/connection.h"

namespace calot::analytics::tables {

template <class Enum>
int number(Enum value) {
  return static_cast<int>(value);
}

/// An enumeration from the database, whose CHECK keeps it in range.
template <class Enum>
Enum enumeration(const SQLite::Column& column) {
  return static_cast<Enum>(column.getInt());
}

inline std::string text(const SQLite::Column& column) { return column.getString(); }

inline std::optional<double> optional(const SQLite::Column& column) {
  return column.isNull() ? std::nullopt : std::optional(column.getDouble());
}

void audit(SQLite::Database& db, const std::string& action, const std::string& subject, const std::string& detail);

/// @throws Error (invalid).
void checkPseudonym(const std::string& pseudonym);
/// Names of criteria and purposes, dates of consent. @throws Error (invalid).
void checkDetails(const std::map<std::string, std::string>& experience,
                  const std::map<std::string, std::string>& consent);
/// -1: there is none.
std::int64_t participantId(SQLite::Database& db, const std::string& pseudonym);
std::int64_t insertParticipant(SQLite::Database& db, const Participant& participant);
/// Adds or replaces the criteria and consents that are given.
void writeDetails(SQLite::Database& db, std::int64_t participant, const std::map<std::string, std::string>& experience,
                  const std::map<std::string, std::string>& consent);

/// -1: there is none.
std::int64_t attemptId(SQLite::Database& db, const std::string& uuid);
std::optional<AttemptRow> findAttempt(SQLite::Database& db, const std::string& uuid);
/// By start, then uuid.
std::vector<AttemptRow> readAttempts(SQLite::Database& db);
/// @throws Error (damaged) for what no recording can say.
void checkAttempt(const AttemptRecord& attempt, const std::string& path);
/// CohortDatabase::storeAttempt() without its transaction; null: values are left alone.
Imported importAttempt(SQLite::Database& db, const std::string& path, const AttemptRecord& attempt,
                       const std::vector<CheckpointValue>* values);

/// BLAKE2b-256 of a uuid, by which a withdrawn attempt is known again (schemas/cohort/0003_governance.sql).
std::array<std::byte, 32> withdrawalDigest(const std::string& uuid);
bool isWithdrawn(SQLite::Database& db, const std::string& uuid);

std::vector<CheckpointValue> readValues(SQLite::Database& db, std::int64_t attempt);
void readAllValues(SQLite::Database& db, const std::vector<std::string>& without,
                   const std::function<void(const AttemptValue&)>& take);
/// SQL: true if the interval (row i of value_interval) is of the value (row c of checkpoint_value), by the present
/// method.
std::string intervalIsOfValue();
/// Intervals of present values, in the values' order.
std::vector<ValueInterval> readIntervals(SQLite::Database& db, std::int64_t attempt);
/// @returns whether anything changed.
bool replaceIntervals(SQLite::Database& db, std::int64_t attempt, const std::vector<ValueInterval>& intervals);
/// Those of external metrics that have the newest version of their name, by name.
std::vector<CheckpointValue> readExternalValues(SQLite::Database& db, std::int64_t attempt);
std::vector<AttemptValue> readAllExternalValues(SQLite::Database& db, const std::vector<std::string>& without);
std::vector<ExternalMetric> readExternalMetrics(SQLite::Database& db);
/// CohortDatabase::checkMetric().
void checkExternalMetric(SQLite::Database& db, const std::string& path, const ExternalMetric& metric);
/// CohortDatabase::storeExternal() without its transaction. @returns how many rows are new.
std::size_t writeExternalValues(SQLite::Database& db, const std::string& path, std::int64_t attempt,
                                const std::vector<CheckpointValue>& values);
/// Removes external values of an attempt whose content has changed. @returns whether there were any.
bool removeExternalValues(SQLite::Database& db, std::int64_t attempt);
/// @returns whether anything changed.
bool replaceValues(SQLite::Database& db, std::int64_t attempt, const std::vector<CheckpointValue>& values);

}  // namespace calot::analytics::tables

namespace calot::analytics {

struct CohortDatabase::Storage {
  std::string path;
  std::unique_ptr<SQLite::Database> db;
};

struct AssessmentDatabase::Storage {
  std::string path;
  std::unique_ptr<SQLite::Database> db;
};

namespace tables {

/// A filled form, and the form itself where it is not there yet; begins no transaction. @throws Error as
/// AssessmentDatabase::storeRating().
void putRating(SQLite::Database& db, const std::string& path, const StoredDocument& form, const Rating& rating,
               bool replace);

}  // namespace tables

}  // namespace calot::analytics
