// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "analytics/cohort/tables.h"

namespace calot::analytics::tables {
namespace {

constexpr const char* valueColumns =
    "c.name, c.subject, c.version, c.availability, c.value, c.reason, c.note, c.unit, c.origin, c.filter, c.coverage ";
constexpr int valueColumnCount = 11;

/// Reuses the text's memory: a large cohort has millions of cells.
void assignText(std::string& to, const SQLite::Column& column) {
  const char* from = column.getText();
  to.assign(from, static_cast<std::size_t>(column.getBytes()));
}

void readValueRow(SQLite::Statement& row, int c, CheckpointValue& v) {
  assignText(v.name, row.getColumn(c++));
  assignText(v.subject, row.getColumn(c++));
  v.version = row.getColumn(c++).getUInt();
  v.availability = enumeration<Availability>(row.getColumn(c++));
  v.value = optional(row.getColumn(c++));
  assignText(v.reason, row.getColumn(c++));
  assignText(v.note, row.getColumn(c++));
  assignText(v.unit, row.getColumn(c++));
  v.origin = enumeration<Origin>(row.getColumn(c++));
  assignText(v.filter, row.getColumn(c++));
  v.coverage = optional(row.getColumn(c));
}

}  // namespace

std::vector<CheckpointValue> readValues(SQLite::Database& db, std::int64_t id) {
  SQLite::Statement select(
      db, fmt::format("SELECT {} FROM checkpoint_value c WHERE c.attempt = ? ORDER BY c.position", valueColumns));
  select.bind(1, id);
  std::vector<CheckpointValue> values;
  while (select.executeStep()) readValueRow(select, 0, values.emplace_back());
  return values;
}

bool replaceValues(SQLite::Database& db, std::int64_t id, const std::vector<CheckpointValue>& values) {
  std::vector<CheckpointValue> before = readValues(db, id);
  if (before == values) return false;
  SQLite::Statement last(db, "SELECT coalesce(max(position) + 1, 0) FROM checkpoint_value WHERE attempt = ?");
  last.bind(1, id);
  last.executeStep();
  if (last.getColumn(0).getInt64() != static_cast<std::int64_t>(before.size())) {  // a gap: row i is not at position i
    SQLite::Statement all(db, "DELETE FROM checkpoint_value WHERE attempt = ?");
    all.bind(1, id);
    all.exec();
    before.clear();
  }
  last.reset();
  // Rows that stay as they are, are not written. Those that go first: a value that moved would meet its old row.
  const auto same = [&](std::size_t i) { return i < before.size() && i < values.size() && before[i] == values[i]; };
  SQLite::Statement clear(db, "DELETE FROM checkpoint_value WHERE attempt = ? AND position = ?");
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (same(i)) continue;
    clear.reset();
    SQLite::bind(clear, id, static_cast<std::int64_t>(i));
    clear.exec();
  }
  SQLite::Statement put(db, "INSERT INTO checkpoint_value VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (same(i)) continue;
    const CheckpointValue& v = values[i];
    put.reset();
    put.clearBindings();
    put.bind(1, id);
    put.bind(2, static_cast<std::int64_t>(i));
    put.bind(3, v.name);
    put.bind(4, v.subject);
    put.bind(5, v.version);
    put.bind(6, number(v.availability));
    bindOptional(put, 7, v.value);
    put.bind(8, v.reason);
    put.bind(9, v.note);
    put.bind(10, v.unit);
    put.bind(11, number(v.origin));
    put.bind(12, v.filter);
    bindOptional(put, 13, v.coverage);
    put.exec();
  }
  return true;
}

void readAllValues(SQLite::Database& db, const std::vector<std::string>& without,
                   const std::function<void(const AttemptValue&)>& take) {
  std::string places;
  for (std::size_t i = 0; i < without.size(); ++i) places += i == 0 ? "?" : ", ?";
  // Most cohorts have no intervals; looking for one beside each value costs as much as reading the values.
  const bool intervals = db.execAndGet("SELECT EXISTS (SELECT 1 FROM value_interval)").getInt() != 0;
  SQLite::Statement select(
      db, fmt::format("SELECT a.uuid, {}{} FROM checkpoint_value c JOIN attempt a ON a.id = c.attempt {} "
                      "WHERE c.name NOT IN ({}) ORDER BY a.uuid, c.position",
                      valueColumns, intervals ? fmt::format(", i.attempt, {}", intervalColumns) : "",
                      intervals ? "LEFT JOIN value_interval i ON " + intervalIsOfValue() : "", places));
  for (std::size_t i = 0; i < without.size(); ++i) select.bind(static_cast<int>(i) + 1, without[i]);
  constexpr int first = 1 + valueColumnCount;
  AttemptValue value;
  while (select.executeStep()) {
    assignText(value.attempt, select.getColumn(0));
    readValueRow(select, 1, value.value);
    value.interval.reset();
    if (intervals && !select.getColumn(first).isNull()) value.interval = intervalRow(select, first + 1);
    take(value);
  }
}

}  // namespace calot::analytics::tables
