// SPDX-License-Identifier: GPL-3.0-or-later
// Access to single tables, which CohortDatabase and AssessmentDatabase combine: tables and rows as SQLite describes
// them, for work that must reach every table, those of later migrations too; and the statements that follow from a
// table's declaration. No function here begins a transaction.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>
#include <SQLiteCpp/VariadicBind.h>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "analytics/cohort/assessment_database.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/connection.h"
#include "analytics/cohort/declared_tables.h"

namespace calot::analytics {

struct ColumnFacts {
  std::string name, type;
};

struct ForeignKey {
  std::string column, parent, parentColumn;
};

struct TableFacts {
  std::string name;
  std::vector<ColumnFacts> columns;
  std::vector<ForeignKey> foreign;  ///< of one column each
  /// The column that only numbers the rows: an integer primary key that is no foreign key; or empty.
  std::string number;
  /// Columns that identify a row: the primary key, the first UNIQUE constraint if the primary key is a mere row id, or
  /// all other columns.
  std::vector<std::string> key;
};

/// Every table but SQLite's own, those that others refer to first.
std::vector<TableFacts> readTables(SQLite::Database& db);

/// A name quoted for SQL.
std::string quotedName(const std::string& name);

using Blob = std::vector<unsigned char>;
/// Content of a column of a row: null, number, text or bytes.
using Cell = std::variant<std::monostate, std::int64_t, double, std::string, Blob>;
using Row = std::map<std::string, Cell>;  ///< by column

Cell cellOf(const SQLite::Column& column);
void bindCell(SQLite::Statement& statement, int at, const Cell& cell);
bool isEmpty(const Cell& cell);           ///< nothing, or an empty text
std::string shownCell(const Cell& cell);  ///< for a message: texts in quotation marks, long bytes cut
std::string textOf(const Cell& cell);     ///< of anything but a text: empty
std::int64_t numberOf(const Cell& cell);  ///< of anything but a whole number: 0
/// Bytes as a cell.
template <std::size_t N>
Blob blobOf(const std::array<std::byte, N>& bytes) {
  Blob blob(N);
  std::memcpy(blob.data(), bytes.data(), N);
  return blob;
}
std::string joined(const std::vector<std::string>& parts, const char* between);

/// Runs a statement with its parameters. @return how many rows it changed
int execute(SQLite::Database& db, const std::string& sql, const std::vector<Cell>& parameters = {});
/// Calls take(statement) at each row of a query.
template <class Take>
void eachRow(SQLite::Database& db, const std::string& sql, const std::vector<Cell>& parameters, Take take) {
  SQLite::Statement query(db, sql);
  int at = 1;
  for (const Cell& cell : parameters) bindCell(query, at++, cell);
  while (query.executeStep()) take(query);
}
/// The first column of every row of a query.
std::vector<Cell> firstColumn(SQLite::Database& db, const std::string& sql, const std::vector<Cell>& parameters = {});
/// The same of texts.
std::vector<std::string> firstTexts(SQLite::Database& db, const std::string& sql,
                                    const std::vector<Cell>& parameters = {});
/// The first column of the first row, a whole number. @param otherwise where there is no row
std::int64_t firstNumber(SQLite::Database& db, const std::string& sql, const std::vector<Cell>& parameters = {},
                         std::int64_t otherwise = -1);

/// Rows of a table, in its primary key's order. @param condition on them, with its parameters; empty: every row
std::vector<Row> readRows(SQLite::Database& db, const TableFacts& table, const std::string& condition = {},
                          const std::vector<Cell>& parameters = {});

}  // namespace calot::analytics

namespace calot::analytics::tables {

inline std::string text(const SQLite::Column& column) { return column.getString(); }

void audit(SQLite::Database& db, const std::string& action, const std::string& subject, const std::string& detail);

/// @param message begins the fault. @throws Error (invalid) for a name that is empty, long or not printable.
void checkName(const std::string& message, const std::string& name);
/// @throws Error (invalid).
inline void checkPseudonym(const std::string& pseudonym) { checkName("participant: a pseudonym", pseudonym); }
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
/// @throws Error (refused) if it is missing. @param path for the message
std::int64_t knownAttempt(SQLite::Database& db, const std::string& path, const std::string& uuid);
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
/// @returns whether anything changed.
bool replaceValues(SQLite::Database& db, std::int64_t attempt, const std::vector<CheckpointValue>& values);

/// A filled form, and the form itself where it is not there yet; begins no transaction. @throws Error as
/// AssessmentDatabase::storeRating().
void putRating(SQLite::Database& db, const std::string& path, const StoredDocument& form, const Rating& rating,
               bool replace);

/// The columns that the table's struct holds, for SELECT: "c.name, c.subject". @param alias of the table in the
/// statement; may be empty
std::string memberColumns(const DeclaredTable& table, const std::string& alias = {});

void readMembers(const DeclaredTable& table, SQLite::Statement& from, int& column, void* row);
/// Reads the members of memberColumns() from `column` on, and moves it behind them.
template <class Row>
void readMembers(const TableOf<Row>& table, SQLite::Statement& from, int& column, Row& row) {
  readMembers(static_cast<const DeclaredTable&>(table), from, column, static_cast<void*>(&row));
}

/// "ON CONFLICT DO UPDATE SET ..." of every column but those that are named.
std::string orUpdateAllBut(const DeclaredTable& table, std::initializer_list<std::string_view> kept);

/// Inserts rows of one table, one after the other.
class RowInsert {
 public:
  /// @param others columns that no member holds, whose cells stand beside each row. @param conflict a clause, or empty
  RowInsert(SQLite::Database& db, const DeclaredTable& table, std::initializer_list<const char*> others = {},
            const std::string& conflict = {});

 protected:
  void insert(const void* row, const std::vector<Cell>& others);

 private:
  const DeclaredTable& table_;
  SQLite::Statement statement_;
};

template <class Row>
class InsertOf : public RowInsert {
 public:
  InsertOf(SQLite::Database& db, const TableOf<Row>& table, std::initializer_list<const char*> others = {},
           const std::string& conflict = {})
      : RowInsert(db, table, others, conflict) {}
  void operator()(const Row& row, const std::vector<Cell>& others = {}) { insert(&row, others); }
};

/// Every row that a clause ("WHERE norm = ? ORDER BY position") selects. @param parameters of the clause
template <class Row>
std::vector<Row> selectRows(SQLite::Database& db, const TableOf<Row>& table, const std::string& clause,
                            const std::vector<Cell>& parameters = {}) {
  std::vector<Row> rows;
  eachRow(db, "SELECT " + memberColumns(table) + " FROM " + table.name + " " + clause, parameters,
          [&](SQLite::Statement& select) {
            int column = 0;
            readMembers(table, select, column, rows.emplace_back());
          });
  return rows;
}

/// Differences between the database's tables and their declaration, one line each.
std::vector<std::string> schemaFaults(SQLite::Database& db);

}  // namespace calot::analytics::tables
