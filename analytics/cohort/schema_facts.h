// SPDX-License-Identifier: GPL-3.0-or-later
// Schema information from SQLite, for operations on all tables including those of later migrations.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <string>
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

}  // namespace calot::analytics
