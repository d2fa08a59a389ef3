// SPDX-License-Identifier: GPL-3.0-or-later
// Statements that follow from a table's declaration (declared_tables.h).
#pragma once

#include <SQLiteCpp/VariadicBind.h>
#include <initializer_list>
#include <string>
#include <vector>

#include "analytics/cohort/any_table.h"
#include "analytics/cohort/declared_tables.h"

namespace calot::analytics::tables {

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
template <class Row, class... Parameters>
std::vector<Row> selectRows(SQLite::Database& db, const TableOf<Row>& table, const std::string& clause,
                            const Parameters&... parameters) {
  SQLite::Statement select(db, "SELECT " + memberColumns(table) + " FROM " + table.name + " " + clause);
  if constexpr (sizeof...(parameters) > 0) SQLite::bind(select, parameters...);
  std::vector<Row> rows;
  while (select.executeStep()) {
    int column = 0;
    readMembers(table, select, column, rows.emplace_back());
  }
  return rows;
}

/// Where the database's tables are not as declared, one line each.
std::vector<std::string> schemaFaults(SQLite::Database& db);

}  // namespace calot::analytics::tables
