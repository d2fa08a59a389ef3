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

/// Every row of a table, in its primary key's order.
std::vector<Row> readRows(SQLite::Database& db, const TableFacts& table);

}  // namespace calot::analytics
