// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/cohort/row_statements.h"

#include <fmt/format.h>

#include <algorithm>

namespace calot::analytics::tables {

std::string memberColumns(const DeclaredTable& table, const std::string& alias) {
  std::vector<std::string> names;
  for (const DeclaredColumn& c : table.columns) {
    if (c.member.read != nullptr) names.push_back(alias.empty() ? c.name : alias + "." + c.name);
  }
  return joined(names, ", ");
}

void readMembers(const DeclaredTable& table, SQLite::Statement& from, int& column, void* row) {
  for (const DeclaredColumn& c : table.columns) {
    if (c.member.read != nullptr) c.member.read(from.getColumn(column++), row);
  }
}

std::string orUpdateAllBut(const DeclaredTable& table, std::initializer_list<std::string_view> kept) {
  std::vector<std::string> changes;
  for (const DeclaredColumn& c : table.columns) {
    if (std::find(kept.begin(), kept.end(), c.name) == kept.end())
      changes.push_back(fmt::format("{0} = excluded.{0}", c.name));
  }
  return " ON CONFLICT DO UPDATE SET " + joined(changes, ", ");
}

namespace {

std::string insertText(const DeclaredTable& table, std::initializer_list<const char*> others,
                       const std::string& conflict) {
  std::vector<std::string> names(others.begin(), others.end());
  for (const DeclaredColumn& c : table.columns) {
    if (c.member.bind != nullptr) names.emplace_back(c.name);
  }
  return fmt::format("INSERT INTO {} ({}) VALUES ({}){}", table.name, joined(names, ", "),
                     joined(std::vector<std::string>(names.size(), "?"), ", "), conflict);
}

}  // namespace

RowInsert::RowInsert(SQLite::Database& db, const DeclaredTable& table, std::initializer_list<const char*> others,
                     const std::string& conflict)
    : table_(table), statement_(db, insertText(table, others, conflict)) {}

void RowInsert::insert(const void* row, const std::vector<Cell>& others) {
  statement_.reset();
  int at = 1;
  for (const Cell& cell : others) bindCell(statement_, at++, cell);
  for (const DeclaredColumn& c : table_.columns) {
    if (c.member.bind != nullptr) c.member.bind(statement_, at++, row);
  }
  statement_.exec();
}

std::vector<std::string> schemaFaults(SQLite::Database& db) {
  std::vector<std::string> faults;
  for (const DeclaredTable* table : cohortTables()) {
    std::map<std::string, std::string> there;
    SQLite::Statement info(db, "SELECT name, type || iif(\"notnull\", ' NOT NULL', '') FROM pragma_table_info(?)");
    info.bind(1, table->name);
    while (info.executeStep()) there[info.getColumn(0).getString()] = info.getColumn(1).getString();
    for (const DeclaredColumn& c : table->columns) {
      const auto at = there.find(c.name);
      if (at == there.end()) {
        faults.push_back(fmt::format("table {} has no column {}", table->name, c.name));
      } else if (at->second != c.type) {
        faults.push_back(fmt::format("column {} of {} is {}, not {}", c.name, table->name, at->second, c.type));
      }
      if (at != there.end()) there.erase(at);
    }
    for (const auto& [name, type] : there)
      faults.push_back(fmt::format("column {} of {} is not of this schema", name, table->name));
  }
  return faults;
}

}  // namespace calot::analytics::tables
