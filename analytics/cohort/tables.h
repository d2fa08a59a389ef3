// SPDX-License-Identifier: GPL-3.0-or-later
// CohortDatabase builds on this. Opening a database: which file it is, its schema, migrations (connection.cpp).
// Single tables: tables and rows as SQLite describes them, for work that must reach every table, those of later
// migrations too; and the statements that follow from a table's declaration. Only CohortConnection::change() begins a
// transaction. The tables' declaration (declared_tables.cpp), each column declared once: name, SQLite's type, meaning,
// unit, values, and the member of the struct that holds it. schemas/cohort/*.sql makes them; statements, `cohort
// check`, lists, codebook and exports follow from the declaration. A new column takes its line there, its member and a
// migration.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>
#include <SQLiteCpp/VariadicBind.h>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "analytics/cohort/blinding.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/registers.h"
#include "recorder/base/errors.h"

namespace calot::analytics {

/// An SQLite message, which may quote content of a damaged file, with '?' for non-ASCII characters.
std::string printable(std::string words);

/// One line for the user that explains an SQLite result code and names the file.
Error databaseError(int sqliteCode, const std::string& message, const std::string& path);

/// Another connection stands in the way.
bool isBusy(const SQLite::Exception& error);

/// "Calo": application id of a cohort database in SQLite's header.
inline constexpr int cohortApplicationId = 0x43616C6F;

/// Between a database's name and the number of the schema that a migration's backup of it has.
inline constexpr const char* backupMark = ".schema-";

/// Opens, checks and (unless read-only) migrates. What an older schema held is kept beside it as
/// PATH.schema-N.bak, N its number. @throws Error as CohortDatabase says.
std::unique_ptr<SQLite::Database> openCohort(const std::string& path, CohortDatabase::Access access,
                                             std::chrono::milliseconds patience);

/// Runs `work` and turns SQLite's exceptions into calot::Error.
template <class Work>
auto guarded(const std::string& path, Work&& work) -> decltype(work()) {
  try {
    return work();
  } catch (const SQLite::Exception& error) {
    throw databaseError(error.getErrorCode(), error.what(), path);
  }
}

/// An open cohort database. Errors of SQLite within `work` become calot::Error.
struct CohortConnection {
  explicit CohortConnection(const std::string& file, CohortDatabase::Access access,
                            std::chrono::milliseconds patience = std::chrono::seconds(10))
      : path(file), db(openCohort(file, access, patience)) {}

  /// work(database).
  template <class Work>
  auto read(Work work) const {
    return guarded(path, [&] { return work(*db); });
  }
  /// work(database) in one transaction, which an exception takes back.
  template <class Work>
  auto change(Work work) {
    return read([&](SQLite::Database& database) {
      SQLite::Transaction transaction(database, SQLite::TransactionBehavior::IMMEDIATE);
      if constexpr (std::is_void_v<decltype(work(database))>) {
        work(database);
        transaction.commit();
      } else {
        auto result = work(database);
        transaction.commit();
        return result;
      }
    });
  }

  std::string path;
  std::unique_ptr<SQLite::Database> db;
};

/// Now, ISO 8601 UTC in seconds: "2014-05-17T09:30:00Z".
std::string nowUtc();

/// Moves one member between its struct and a statement or a list; empty where no struct holds the column.
struct ColumnMember {
  void (*bind)(SQLite::Statement& statement, int index, const void* row) = nullptr;
  void (*read)(const SQLite::Column& from, void* row) = nullptr;
  FieldValue (*value)(const void* row) = nullptr;
};

struct DeclaredColumn {
  const char* name;
  const char* type;  ///< as in the schema: "REAL", or "REAL NOT NULL"
  const char* meaning;
  ColumnMember member = {};
  const char* unit = "";
  const char* allowed = "";  ///< empty: any value of the type
  const char* missing = "";  ///< what stands where there is none; empty: never missing
  const char* listed = "";   ///< its name in lists (fieldsOf()); empty: `name`
};

struct DeclaredTable {
  const char* name;
  std::vector<DeclaredColumn> columns;
};

/// A table whose members are of `Row`.
template <class Row>
struct TableOf : DeclaredTable {};

extern const TableOf<Participant> participantTable;
extern const TableOf<AttemptRecord> attemptTable;
extern const TableOf<AttemptRecord> recordingTable;
extern const TableOf<RecordingSignature> signatureTable;
extern const TableOf<Verification> verificationTable;
extern const TableOf<CheckpointValue> checkpointValueTable;
extern const TableOf<ExternalMetric> externalMetricTable;
extern const TableOf<CheckpointValue> externalValueTable;
extern const TableOf<ValueInterval> valueIntervalTable;
extern const TableOf<Station> stationTable;
extern const TableOf<RegisteredProtocol> protocolTable;
extern const TableOf<StoredDocument> formTable;
extern const TableOf<AnalysisLock> analysisLockTable;
extern const TableOf<Norm> normTable;
extern const TableOf<NormCheckpoint> normCheckpointTable;
extern const TableOf<NormEvidence> normEvidenceTable;

/// All of them, with those that no struct holds.
const std::vector<const DeclaredTable*>& cohortTables();
/// Views of the analysis set, as `cohort export` writes them.
const std::vector<DeclaredTable>& cohortViews();
/// A column of a table; null if the table lacks it.
const DeclaredColumn* findColumn(std::string_view table, std::string_view column);

struct ColumnFacts {
  std::string name, type;
  /// Does it hold times that Calot wrote? They are no content, and name nobody: a pseudonym may be a number, too.
  [[nodiscard]] bool isTime() const { return name.ends_with("_utc"); }
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
/// As CohortDatabase::valuesOf().
std::map<std::string, CheckpointValue> readValuesOf(SQLite::Database& db, std::string_view checkpoint);
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
/// CohortDatabase::storeRating().
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

/// Tables, views, indices and triggers that are not as the migrations make them, one line each.
std::vector<std::string> schemaFaults(SQLite::Database& db);
/// Numbers that the program never writes, one line each. @pre the database is a copy, in which a table may be made
std::vector<std::string> valueFaults(SQLite::Database& db);

}  // namespace calot::analytics::tables
