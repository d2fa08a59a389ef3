// SPDX-License-Identifier: GPL-3.0-or-later
// Intervals of values, beside the values that they are of.
#include <fmt/format.h>

#include <bit>
#include <cstring>

#include "analytics/cohort/tables.h"

static_assert(std::endian::native == std::endian::little, "the file's doubles are little-endian");

namespace calot::analytics::tables {

std::string intervalIsOfValue() {
  return fmt::format(
      "i.attempt = c.attempt AND i.name = c.name AND i.subject = c.subject AND i.version = c.version AND "
      "i.value = c.value AND i.method = {}",
      intervalMethod);
}

ValueInterval intervalRow(SQLite::Statement& row, int c) {
  ValueInterval i;
  i.name = text(row.getColumn(c++));
  i.subject = text(row.getColumn(c++));
  i.version = row.getColumn(c++).getUInt();
  i.value = row.getColumn(c++).getDouble();
  i.stepEffect = row.getColumn(c++).getDouble();
  i.meshEffect = row.getColumn(c++).getDouble();
  i.constantsSpread = row.getColumn(c++).getDouble();
  i.lower = optional(row.getColumn(c++));
  i.upper = optional(row.getColumn(c++));
  i.reason = text(row.getColumn(c++));
  const SQLite::Column runs = row.getColumn(c);
  i.runs.resize(static_cast<std::size_t>(runs.getBytes()) / sizeof(double));
  if (!i.runs.empty()) std::memcpy(i.runs.data(), runs.getBlob(), i.runs.size() * sizeof(double));
  return i;
}

std::vector<ValueInterval> readIntervals(SQLite::Database& db, std::int64_t id) {
  SQLite::Statement select(db, fmt::format("SELECT {} FROM value_interval i JOIN checkpoint_value c ON {} WHERE "
                                           "c.attempt = ? ORDER BY c.position",
                                           intervalColumns, intervalIsOfValue()));
  select.bind(1, id);
  std::vector<ValueInterval> intervals;
  while (select.executeStep()) intervals.push_back(intervalRow(select, 0));
  return intervals;
}

bool replaceIntervals(SQLite::Database& db, std::int64_t id, const std::vector<ValueInterval>& intervals) {
  if (readIntervals(db, id) == intervals) return false;
  SQLite::Statement clear(db, "DELETE FROM value_interval WHERE attempt = ?");
  clear.bind(1, id);
  clear.exec();
  SQLite::Statement put(db, "INSERT INTO value_interval VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  for (const ValueInterval& i : intervals) {
    put.reset();
    put.clearBindings();
    put.bind(1, id);
    put.bind(2, i.name);
    put.bind(3, i.subject);
    put.bind(4, i.version);
    put.bind(5, intervalMethod);
    put.bind(6, i.value);
    put.bind(7, i.stepEffect);
    put.bind(8, i.meshEffect);
    put.bind(9, i.constantsSpread);
    bindOptional(put, 10, i.lower);
    bindOptional(put, 11, i.upper);
    put.bind(12, i.reason);
    // A null pointer would be NULL, even with no bytes.
    static const double none = 0.0;
    put.bind(13, i.runs.empty() ? &none : i.runs.data(), static_cast<int>(i.runs.size() * sizeof(double)));
    put.exec();
  }
  return true;
}

}  // namespace calot::analytics::tables
