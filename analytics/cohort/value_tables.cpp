// SPDX-License-Identifier: GPL-3.0-or-later
// Values of checkpoints, their intervals, and external metrics with their values.

#include <fmt/format.h>
#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <utility>

#include "analytics/cohort/connection.h"
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

namespace {

using MetricById = std::map<std::int64_t, ExternalMetricRef>;

/// Each is one object, which its values share.
MetricById metricsById(SQLite::Database& db) {
  SQLite::Statement select(db, "SELECT id, name, version, title, unit, direction, sha256 FROM external_metric");
  MetricById metrics;
  while (select.executeStep()) {
    ExternalMetric m;
    CheckpointDefinition& d = m.definition;
    d.name = text(select.getColumn(1));
    d.version = select.getColumn(2).getUInt();
    d.title = text(select.getColumn(3));
    d.unit = d.displayUnit = text(select.getColumn(4));
    d.direction = enumeration<Direction>(select.getColumn(5));
    d.window = "whole attempt";
    d.filter = "none";
    d.origins = {Origin::external};
    d.finality = Finality::final;
    m.sha256 = text(select.getColumn(6));
    d.definition = "script with SHA-256 " + m.sha256;
    metrics.emplace(select.getColumn(0).getInt64(), ExternalMetricRef(std::move(m)));
  }
  return metrics;
}

/// Of the rows of external_value as e with metric m.
constexpr const char* newest =
    "NOT EXISTS (SELECT 1 FROM external_value l JOIN external_metric n ON n.id = l.metric WHERE l.attempt = e.attempt "
    "AND n.name = m.name AND n.version > m.version)";

constexpr const char* externalColumns = "e.metric, e.availability, e.value, e.reason, e.note";

CheckpointValue externalRow(SQLite::Statement& row, int c, const MetricById& metrics) {
  CheckpointValue v;
  v.metric = metrics.at(row.getColumn(c++).getInt64());
  v.availability = enumeration<Availability>(row.getColumn(c++));
  v.value = optional(row.getColumn(c++));
  v.reason = text(row.getColumn(c++));
  v.note = text(row.getColumn(c));
  const CheckpointDefinition& d = v.metric->definition;
  v.name = d.name;
  v.version = d.version;
  v.unit = d.unit;
  v.origin = Origin::external;
  v.filter = d.filter;
  return v;
}

std::int64_t registered(SQLite::Database& db, const std::string& path, const ExternalMetric& metric) {
  checkExternalMetric(db, path, metric);
  const CheckpointDefinition& d = metric.definition;
  SQLite::Statement find(db, "SELECT id FROM external_metric WHERE name = ? AND version = ?");
  SQLite::bind(find, d.name, d.version);
  if (find.executeStep()) return find.getColumn(0).getInt64();
  SQLite::Statement put(db,
                        "INSERT INTO external_metric (name, version, title, unit, direction, sha256, registered_utc) "
                        "VALUES (?, ?, ?, ?, ?, ?, ?)");
  SQLite::bind(put, d.name, d.version, d.title, d.unit, number(d.direction), metric.sha256, nowUtc());
  put.exec();
  const std::int64_t id = db.getLastInsertRowid();
  audit(db, "metric-add", fmt::format("{} {}", d.name, d.version), "SHA-256 " + metric.sha256);
  return id;
}

std::string shownValue(const std::optional<double>& value) { return value ? fmt::format("{}", *value) : "no value"; }

}  // namespace

std::vector<ExternalMetric> readExternalMetrics(SQLite::Database& db) {
  std::map<std::pair<std::string, std::uint32_t>, ExternalMetric> sorted;
  for (const auto& [id, metric] : metricsById(db))
    sorted.emplace(std::pair(metric->definition.name, metric->definition.version), *metric);
  std::vector<ExternalMetric> metrics;
  metrics.reserve(sorted.size());
  for (auto& item : sorted) metrics.push_back(std::move(item.second));
  return metrics;
}

void checkExternalMetric(SQLite::Database& db, const std::string& path, const ExternalMetric& metric) {
  const CheckpointDefinition& d = metric.definition;
  SQLite::Statement select(db, "SELECT version, sha256 FROM external_metric WHERE name = ? ORDER BY version DESC");
  select.bind(1, d.name);
  for (bool first = true; select.executeStep(); first = false) {
    const std::uint32_t version = select.getColumn(0).getUInt();
    if (first && version > d.version)
      throw Error(ErrorKind::refused,
                  fmt::format("{} is version {}, {} has version {} already", d.name, d.version, path, version));
    if (version == d.version && text(select.getColumn(1)) != metric.sha256)
      throw Error(ErrorKind::refused, fmt::format("{} version {} was another text when {} took it in; raise VERSION",
                                                  d.name, version, path));
  }
}

std::vector<CheckpointValue> readExternalValues(SQLite::Database& db, std::int64_t attempt) {
  const MetricById metrics = metricsById(db);
  std::vector<CheckpointValue> values;
  if (metrics.empty()) return values;
  SQLite::Statement select(db, fmt::format("SELECT {} FROM external_value e JOIN external_metric m ON m.id = e.metric "
                                           "WHERE e.attempt = ? AND {} ORDER BY m.name",
                                           externalColumns, newest));
  select.bind(1, attempt);
  while (select.executeStep()) values.push_back(externalRow(select, 0, metrics));
  return values;
}

std::vector<AttemptValue> readAllExternalValues(SQLite::Database& db, const std::vector<std::string>& without) {
  const MetricById metrics = metricsById(db);
  std::vector<AttemptValue> values;
  if (metrics.empty()) return values;
  SQLite::Statement select(
      db, fmt::format("SELECT a.uuid, {} FROM external_value e JOIN external_metric m ON m.id = e.metric JOIN attempt "
                      "a ON a.id = e.attempt WHERE {} ORDER BY a.uuid, m.name",
                      externalColumns, newest));
  while (select.executeStep()) {
    CheckpointValue v = externalRow(select, 1, metrics);
    if (std::find(without.begin(), without.end(), v.name) != without.end()) continue;
    values.push_back({text(select.getColumn(0)), std::move(v), {}});
  }
  return values;
}

std::size_t writeExternalValues(SQLite::Database& db, const std::string& path, std::int64_t attempt,
                                const std::vector<CheckpointValue>& values) {
  std::size_t added = 0;
  for (const CheckpointValue& v : values) {
    const std::int64_t metric = registered(db, path, *v.metric);
    SQLite::Statement find(db, "SELECT value, reason, note FROM external_value WHERE attempt = ? AND metric = ?");
    SQLite::bind(find, attempt, metric);
    if (find.executeStep()) {
      const std::optional<double> known = optional(find.getColumn(0));
      if (known == v.value && text(find.getColumn(1)) == v.reason && text(find.getColumn(2)) == v.note) continue;
      throw Error(ErrorKind::refused,
                  fmt::format("{} version {} gave {} of this attempt before and gives {} now; a metric gives the same "
                              "value each time, or raise VERSION",
                              v.name, v.version, shownValue(known), shownValue(v.value)));
    }
    SQLite::Statement put(db, "INSERT INTO external_value VALUES (?, ?, ?, ?, ?, ?)");
    put.bind(1, attempt);
    put.bind(2, metric);
    put.bind(3, number(v.availability));
    bindOptional(put, 4, v.value);
    put.bind(5, v.reason);
    put.bind(6, v.note);
    put.exec();
    ++added;
  }
  return added;
}

bool removeExternalValues(SQLite::Database& db, std::int64_t attempt) {
  SQLite::Statement clear(db, "DELETE FROM external_value WHERE attempt = ?");
  clear.bind(1, attempt);
  return clear.exec() > 0;
}

}  // namespace calot::analytics::tables
