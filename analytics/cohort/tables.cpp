// SPDX-License-Identifier: GPL-3.0-or-later
// Any table; rows of participants and of the audit trail.

#include "analytics/cohort/tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <set>

#include "analytics/cohort/embedded.h"
#include "recorder/base/counted.h"
#include "recorder/base/dates.h"
#include "recorder/base/files.h"

namespace calot::analytics {
namespace {

TableFacts factsOf(SQLite::Database& db, const std::string& name) {
  TableFacts t;
  t.name = name;
  eachRow(db, "SELECT name, type FROM pragma_table_info(?) ORDER BY cid", {name}, [&](SQLite::Statement& row) {
    t.columns.push_back({row.getColumn(0).getString(), row.getColumn(1).getString()});
  });
  // A key that names no column of its parent refers to the primary key.
  eachRow(
      db,
      "SELECT \"from\", \"table\", coalesce(\"to\", (SELECT name FROM pragma_table_info(\"table\") WHERE pk = 1), '') "
      "FROM pragma_foreign_key_list(?) ORDER BY id, seq",
      {name}, [&](SQLite::Statement& row) {
        t.foreign.push_back({row.getColumn(0).getString(), row.getColumn(1).getString(), row.getColumn(2).getString()});
      });
  const auto primary = firstTexts(db, "SELECT name FROM pragma_table_info(?) WHERE pk > 0 ORDER BY pk", {name});
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
        firstTexts(db,
                   "SELECT name FROM pragma_index_list(?) WHERE \"unique\" = 1 AND origin = 'u' AND partial = 0 "
                   "ORDER BY seq DESC",
                   {name});
    t.key.clear();
    if (!unique.empty()) {
      t.key = firstTexts(db, "SELECT name FROM pragma_index_info(?) ORDER BY seqno", {unique.front()});
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
  for (const std::string& name : firstTexts(db,
                                            "SELECT name FROM sqlite_master WHERE type = 'table' AND name NOT LIKE "
                                            "'sqlite\\_%' ESCAPE '\\' ORDER BY name"))
    rest.push_back(factsOf(db, name));
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

Cell cellOf(const SQLite::Column& column) {
  if (column.isInteger()) return column.getInt64();
  if (column.isFloat()) return column.getDouble();
  if (column.isText()) return column.getString();
  if (column.isBlob()) {
    const auto* bytes = static_cast<const unsigned char*>(column.getBlob());
    return Blob(bytes, bytes + column.getBytes());
  }
  return std::monostate{};
}

void bindCell(SQLite::Statement& statement, int at, const Cell& cell) {
  if (const auto* i = std::get_if<std::int64_t>(&cell)) {
    statement.bind(at, *i);
  } else if (const auto* d = std::get_if<double>(&cell)) {
    statement.bind(at, *d);
  } else if (const auto* s = std::get_if<std::string>(&cell)) {
    statement.bind(at, *s);
  } else if (const auto* b = std::get_if<Blob>(&cell)) {
    statement.bind(at, b->data(), static_cast<int>(b->size()));
  } else {
    statement.bind(at);
  }
}

bool isEmpty(const Cell& cell) {
  const auto* s = std::get_if<std::string>(&cell);
  return std::holds_alternative<std::monostate>(cell) || (s != nullptr && s->empty());
}

std::string shownCell(const Cell& cell) {
  if (const auto* i = std::get_if<std::int64_t>(&cell)) return fmt::format("{}", *i);
  if (const auto* d = std::get_if<double>(&cell)) return fmt::format("{}", *d);
  if (const auto* s = std::get_if<std::string>(&cell)) return fmt::format("\"{}\"", *s);
  if (const auto* b = std::get_if<Blob>(&cell)) {
    const std::string hex = recorder::hexOf(*b);
    return hex.size() > 16 ? hex.substr(0, 16) + "..." : hex;
  }
  return "nothing";
}

std::string textOf(const Cell& cell) {
  const auto* s = std::get_if<std::string>(&cell);
  return s == nullptr ? std::string() : *s;
}

std::int64_t numberOf(const Cell& cell) {
  const auto* i = std::get_if<std::int64_t>(&cell);
  return i == nullptr ? 0 : *i;
}

std::string joined(const std::vector<std::string>& parts, const char* between) {
  return fmt::format("{}", fmt::join(parts, between));
}

int execute(SQLite::Database& db, const std::string& sql, const std::vector<Cell>& parameters) {
  SQLite::Statement statement(db, sql);
  int at = 1;
  for (const Cell& cell : parameters) bindCell(statement, at++, cell);
  return statement.exec();
}

std::vector<Cell> firstColumn(SQLite::Database& db, const std::string& sql, const std::vector<Cell>& parameters) {
  std::vector<Cell> cells;
  eachRow(db, sql, parameters, [&](SQLite::Statement& row) { cells.push_back(cellOf(row.getColumn(0))); });
  return cells;
}

std::vector<std::string> firstTexts(SQLite::Database& db, const std::string& sql, const std::vector<Cell>& parameters) {
  std::vector<std::string> texts;
  for (const Cell& cell : firstColumn(db, sql, parameters)) texts.push_back(textOf(cell));
  return texts;
}

std::int64_t firstNumber(SQLite::Database& db, const std::string& sql, const std::vector<Cell>& parameters,
                         std::int64_t otherwise) {
  const std::vector<Cell> cells = firstColumn(db, sql, parameters);
  return cells.empty() ? otherwise : numberOf(cells.front());
}

std::vector<Row> readRows(SQLite::Database& db, const TableFacts& table, const std::string& condition,
                          const std::vector<Cell>& parameters) {
  std::vector<std::string> columns, order;
  for (const ColumnFacts& c : table.columns) columns.push_back(quotedName(c.name));
  for (const std::string& k : table.key) order.push_back(quotedName(k));
  if (!table.number.empty()) order = {quotedName(table.number)};
  std::string query = fmt::format("SELECT {} FROM {}", joined(columns, ", "), quotedName(table.name));
  if (!condition.empty()) query += " WHERE " + condition;
  if (!order.empty()) query += " ORDER BY " + joined(order, ", ");
  std::vector<Row> rows;
  eachRow(db, query, parameters, [&](SQLite::Statement& read) {
    Row& row = rows.emplace_back();
    for (std::size_t c = 0; c < table.columns.size(); ++c)
      row[table.columns[c].name] = cellOf(read.getColumn(static_cast<int>(c)));
  });
  return rows;
}

}  // namespace calot::analytics

namespace calot::analytics::tables {

void audit(SQLite::Database& db, const std::string& action, const std::string& subject, const std::string& detail) {
  execute(db, "INSERT INTO audit (at_utc, action, subject, detail) VALUES (?, ?, ?, ?)",
          {nowUtc(), action, subject, detail});
}

void checkName(const std::string& message, const std::string& name) {
  const auto control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; };
  if (name.empty() || name.size() > 64 || name.front() == ' ' || name.back() == ' ' ||
      std::any_of(name.begin(), name.end(), control)) {
    throw Error(ErrorKind::invalid,
                message + " has 1 to 64 characters, no control characters and no blank at its ends");
  }
}

void checkDetails(const std::map<std::string, std::string>& experience,
                  const std::map<std::string, std::string>& consent) {
  for (const auto& item : experience) {
    if (item.first.empty()) throw Error(ErrorKind::invalid, "experience: a criterion needs a name (criterion=value)");
  }
  for (const auto& [purpose, date] : consent) {
    if (purpose.empty()) throw Error(ErrorKind::invalid, "consent: a purpose needs a name (purpose:YYYY-MM-DD)");
    if (!recorder::isDate(date + "T00:00:00Z"))
      throw Error(ErrorKind::invalid, fmt::format("consent {}: \"{}\" is not a date (YYYY-MM-DD)", purpose, date));
  }
}

std::int64_t participantId(SQLite::Database& db, const std::string& pseudonym) {
  return firstNumber(db, "SELECT id FROM participant WHERE pseudonym = ?", {pseudonym});
}

std::int64_t insertParticipant(SQLite::Database& db, const Participant& p) {
  InsertOf(db, participantTable, {"created_utc"})(p, {nowUtc()});
  return db.getLastInsertRowid();
}

void writeDetails(SQLite::Database& db, std::int64_t id, const std::map<std::string, std::string>& experience,
                  const std::map<std::string, std::string>& consent) {
  for (const auto& [criterion, value] : experience) {
    execute(db, "INSERT INTO participant_experience VALUES (?, ?, ?) ON CONFLICT DO UPDATE SET value = excluded.value",
            {id, criterion, value});
  }
  for (const auto& [purpose, date] : consent) {
    execute(db, "INSERT INTO consent VALUES (?, ?, ?) ON CONFLICT DO UPDATE SET given_on = excluded.given_on",
            {id, purpose, date});
  }
}

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

namespace {

/// By kind and name the statements that made what a database has, without comments and blanks: those of the migrations
/// may change.
std::map<std::string, std::string> statementsOf(SQLite::Database& db) {
  std::map<std::string, std::string> parts;
  eachRow(db, "SELECT type || ' ' || name, sql FROM sqlite_master WHERE name NOT LIKE 'sqlite!_%' ESCAPE '!'", {},
          [&](SQLite::Statement& row) {
            std::string& statement = parts[printable(text(row.getColumn(0)))];
            const std::string sql = text(row.getColumn(1));
            for (std::size_t at = 0; at < sql.size(); ++at) {
              if (sql.compare(at, 2, "--") == 0) at = std::min(sql.find('\n', at), sql.size() - 1);
              if (std::string_view(" \t\r\n").find(sql[at]) == std::string_view::npos) statement += sql[at];
            }
          });
  return parts;
}

}  // namespace

std::vector<std::string> schemaFaults(SQLite::Database& db) {
  static const std::map<std::string, std::string> ours = [] {
    SQLite::Database made(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    for (const Migration& migration : cohortMigrations()) made.exec(migration.sql);
    return statementsOf(made);
  }();
  std::vector<std::string> faults;
  const std::map<std::string, std::string> there = statementsOf(db);
  for (const auto& [part, statement] : ours) {
    const auto at = there.find(part);
    if (at == there.end() || at->second != statement)
      faults.push_back(fmt::format("{} {}", part, at == there.end() ? "is missing" : "is not as Calot makes it"));
  }
  for (const auto& [part, statement] : there) {
    if (!ours.contains(part)) faults.push_back(fmt::format("{} is not one of Calot's", part));
  }
  return faults;
}

std::vector<std::string> valueFaults(SQLite::Database& db) {
  std::vector<std::string> faults;
  for (const DeclaredTable* table : cohortTables()) {
    for (const DeclaredColumn& c : table->columns) {
      if (std::string_view(c.type).substr(0, 4) != "REAL") continue;
      const auto count = firstNumber(
          db, fmt::format("SELECT count(*) FROM {} WHERE abs({}) > 1.7976931348623157e308", table->name, c.name));
      if (count > 0)
        faults.push_back(fmt::format("{} of {}.{} {} not finite", recorder::counted(count, "number"), table->name,
                                     c.name, count == 1 ? "is" : "are"));
    }
  }
  db.exec("CREATE TEMP TABLE figure (name TEXT PRIMARY KEY, version, unit, negative, broken)");
  for (const CheckpointEntry& entry : checkpointRegistry()) {
    const CheckpointDefinition& d = entry.definition;
    execute(db, "INSERT INTO figure VALUES (?, ?, ?, ?, ?)",
            {d.name, std::int64_t{d.version}, d.unit, std::int64_t{d.domain == Domain::any},
             std::int64_t{d.domain != Domain::whole}});
  }
  for (std::string& line : firstTexts(
           db,
           "SELECT count(*) || ' values of ' || v.name || ' cannot be, as ' || v.value || ' ' || v.unit || ' of "
           "attempt "
           "' || a.uuid FROM checkpoint_value v JOIN figure f USING (name, version) JOIN attempt a ON a.id = v.attempt "
           "WHERE v.unit <> f.unit OR (v.value < 0 AND NOT f.negative) OR (v.value <> round(v.value) AND NOT f.broken) "
           "GROUP BY v.name"))
    faults.push_back(printable(std::move(line)));
  return faults;
}

}  // namespace calot::analytics::tables
