// SPDX-License-Identifier: GPL-3.0-or-later
// Tables and rows as SQLite describes them, for work that must reach every table, those of later migrations too.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <variant>
#include <vector>

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
std::string hexOf(const Blob& bytes);
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
