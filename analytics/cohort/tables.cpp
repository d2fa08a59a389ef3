// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of participants and of the audit trail.

#include "analytics/cohort/tables.h"

#include <fmt/format.h>
#include <algorithm>

#include "analytics/cohort/connection.h"
#include "recorder/base/dates.h"

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
  InsertOf(db, participantTable(), {"created_utc"})(p, {nowUtc()});
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

std::vector<std::string> schemaFaults(SQLite::Database& db) {
  std::vector<std::string> faults;
  for (const DeclaredTable* table : cohortTables()) {
    std::map<std::string, std::string> there;
    eachRow(db, "SELECT name, type || iif(\"notnull\", ' NOT NULL', '') FROM pragma_table_info(?)", {table->name},
            [&](SQLite::Statement& row) { there[text(row.getColumn(0))] = text(row.getColumn(1)); });
    for (const DeclaredColumn& c : table->columns) {
      const auto at = there.find(c.name);
      if (at == there.end()) {
        faults.push_back(fmt::format("table {} has no column {}", table->name, c.name));
        continue;
      }
      if (at->second != c.type)
        faults.push_back(fmt::format("column {} of {} is {}, not {}", c.name, table->name, at->second, c.type));
      there.erase(at);
    }
    for (const auto& [name, type] : there)
      faults.push_back(fmt::format("column {} of {} is not of this schema", name, table->name));
  }
  return faults;
}

}  // namespace calot::analytics::tables
