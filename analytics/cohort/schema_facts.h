// SPDX-License-Identifier: GPL-3.0-or-later
// What SQLite says of the tables of a database: for work that must reach every table, those of later migrations too.
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
  /// What makes two rows the same: the primary key, the first UNIQUE where the primary key only numbers, or all other
  /// columns.
  std::vector<std::string> key;
};

/// Every table but SQLite's own, those that others refer to first.
std::vector<TableFacts> readTables(SQLite::Database& db);

/// A name as SQL wants it.
std::string quotedName(const std::string& name);

}  // namespace calot::analytics
