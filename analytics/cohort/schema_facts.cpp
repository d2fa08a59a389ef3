// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/cohort/schema_facts.h"

#include <algorithm>
#include <set>

namespace calot::analytics {
namespace {

std::vector<std::string> texts(SQLite::Database& db, const char* sql, const std::string& about) {
  SQLite::Statement read(db, sql);
  read.bind(1, about);
  std::vector<std::string> all;
  while (read.executeStep()) all.push_back(read.getColumn(0).getString());
  return all;
}

TableFacts factsOf(SQLite::Database& db, const std::string& name) {
  TableFacts t;
  t.name = name;
  SQLite::Statement columns(db, "SELECT name, type FROM pragma_table_info(?) ORDER BY cid");
  columns.bind(1, name);
  while (columns.executeStep())
    t.columns.push_back({columns.getColumn(0).getString(), columns.getColumn(1).getString()});
  SQLite::Statement foreign(db,
                            "SELECT \"from\", \"table\", coalesce(\"to\", '') FROM pragma_foreign_key_list(?) "
                            "ORDER BY id, seq");
  foreign.bind(1, name);
  while (foreign.executeStep()) {
    ForeignKey key{foreign.getColumn(0).getString(), foreign.getColumn(1).getString(),
                   foreign.getColumn(2).getString()};
    if (key.parentColumn.empty()) {
      const auto primary = texts(db, "SELECT name FROM pragma_table_info(?) WHERE pk = 1", key.parent);
      if (!primary.empty()) key.parentColumn = primary.front();
    }
    t.foreign.push_back(std::move(key));
  }
  const auto primary = texts(db, "SELECT name FROM pragma_table_info(?) WHERE pk > 0 ORDER BY pk", name);
  const auto isForeign = [&](const std::string& column) {
    return std::any_of(t.foreign.begin(), t.foreign.end(), [&](const ForeignKey& k) { return k.column == column; });
  };
  const auto typeOf = [&](const std::string& column) {
    const auto at = std::find_if(t.columns.begin(), t.columns.end(), [&](const auto& c) { return c.name == column; });
    return at == t.columns.end() ? std::string() : at->type;
  };
  if (primary.size() == 1 && typeOf(primary[0]) == "INTEGER" && !isForeign(primary[0])) t.number = primary[0];
  t.key = primary;
  if (primary.empty() || !t.number.empty()) {
    const auto unique =
        texts(db,
              "SELECT name FROM pragma_index_list(?) WHERE \"unique\" = 1 AND origin = 'u' AND partial = 0 "
              "ORDER BY seq DESC",
              name);
    t.key.clear();
    if (!unique.empty()) {
      t.key = texts(db, "SELECT name FROM pragma_index_info(?) ORDER BY seqno", unique.front());
    } else {
      for (const ColumnFacts& c : t.columns) {
        if (c.name != t.number) t.key.push_back(c.name);
      }
    }
  }
  return t;
}

}  // namespace

std::vector<TableFacts> readTables(SQLite::Database& db) {
  std::vector<TableFacts> rest, ordered;
  SQLite::Statement names(
      db,
      "SELECT name FROM sqlite_master WHERE type = 'table' AND name NOT LIKE 'sqlite\\_%' ESCAPE '\\' ORDER BY name");
  while (names.executeStep()) rest.push_back(factsOf(db, names.getColumn(0).getString()));
  std::set<std::string> done;
  while (!rest.empty()) {
    const auto free = std::find_if(rest.begin(), rest.end(), [&](const TableFacts& t) {
      return std::all_of(t.foreign.begin(), t.foreign.end(),
                         [&](const ForeignKey& k) { return k.parent == t.name || done.count(k.parent) > 0; });
    });
    const auto next = free == rest.end() ? rest.begin() : free;  // tables that refer to each other: in any order
    done.insert(next->name);
    ordered.push_back(std::move(*next));
    rest.erase(next);
  }
  return ordered;
}

std::string quotedName(const std::string& name) {
  std::string quoted = "\"";
  for (const char c : name) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace calot::analytics
