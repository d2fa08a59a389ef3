// SPDX-License-Identifier: GPL-3.0-or-later
// Values of checkpoints, their intervals, and external metrics with their values.

#include <fmt/format.h>
#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <utility>

#include "analytics/cohort/connection.h"
#include "analytics/cohort/row_statements.h"
#include "analytics/cohort/tables.h"

namespace calot::analytics::tables {
std::vector<CheckpointValue> readValues(SQLite::Database& db, std::int64_t id) {
  return selectRows(db, checkpointValueTable(), "WHERE attempt = ? ORDER BY position", id);
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
  InsertOf put(db, checkpointValueTable(), {"attempt", "position"});
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!same(i)) put(values[i], {id, static_cast<std::int64_t>(i)});
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
                      memberColumns(checkpointValueTable(), "c"),
                      intervals ? ", i.attempt, " + memberColumns(valueIntervalTable(), "i") : "",
                      intervals ? "LEFT JOIN value_interval i ON " + intervalIsOfValue() : "", places));
  for (std::size_t i = 0; i < without.size(); ++i) select.bind(static_cast<int>(i) + 1, without[i]);
  AttemptValue value;
  while (select.executeStep()) {
    int c = 0;
    value.attempt = text(select.getColumn(c++));
    readMembers(checkpointValueTable(), select, c, value.value);
    value.interval.reset();
    if (intervals && !select.getColumn(c++).isNull())
      readMembers(valueIntervalTable(), select, c, value.interval.emplace());
    take(value);
  }
}

std::string intervalIsOfValue() {
  return fmt::format(
      "i.attempt = c.attempt AND i.name = c.name AND i.subject = c.subject AND i.version = c.version AND "
      "i.value = c.value AND i.method = {}",
      intervalMethod);
}

std::vector<ValueInterval> readIntervals(SQLite::Database& db, std::int64_t id) {
  SQLite::Statement select(db, fmt::format("SELECT {} FROM value_interval i JOIN checkpoint_value c ON {} WHERE "
                                           "c.attempt = ? ORDER BY c.position",
                                           memberColumns(valueIntervalTable(), "i"), intervalIsOfValue()));
  select.bind(1, id);
  std::vector<ValueInterval> intervals;
  while (select.executeStep()) {
    int c = 0;
    readMembers(valueIntervalTable(), select, c, intervals.emplace_back());
  }
  return intervals;
}

bool replaceIntervals(SQLite::Database& db, std::int64_t id, const std::vector<ValueInterval>& intervals) {
  if (readIntervals(db, id) == intervals) return false;
  SQLite::Statement clear(db, "DELETE FROM value_interval WHERE attempt = ?");
  clear.bind(1, id);
  clear.exec();
  InsertOf put(db, valueIntervalTable(), {"attempt", "method"});
  for (const ValueInterval& i : intervals) put(i, {id, std::int64_t{intervalMethod}});
  return true;
}

namespace {

using MetricById = std::map<std::int64_t, ExternalMetricRef>;

/// Each is one object, which its values share.
MetricById metricsById(SQLite::Database& db) {
  SQLite::Statement select(db, fmt::format("SELECT id, {} FROM external_metric", memberColumns(externalMetricTable())));
  MetricById metrics;
  while (select.executeStep()) {
    ExternalMetric m;
    int c = 1;
    readMembers(externalMetricTable(), select, c, m);
    CheckpointDefinition& d = m.definition;
    d.displayUnit = d.unit;
    d.window = "whole attempt";
    d.filter = "none";
    d.origins = {Origin::external};
    d.finality = Finality::final;
    d.definition = "script with SHA-256 " + m.sha256;
    metrics.emplace(select.getColumn(0).getInt64(), ExternalMetricRef(std::move(m)));
  }
  return metrics;
}

/// Selects rows of external_value (alias e) with metric m.
constexpr const char* newest =
    "NOT EXISTS (SELECT 1 FROM external_value l JOIN external_metric n ON n.id = l.metric WHERE l.attempt = e.attempt "
    "AND n.name = m.name AND n.version > m.version)";

std::string externalColumns() { return "e.metric, " + memberColumns(externalValueTable(), "e"); }

CheckpointValue externalRow(SQLite::Statement& row, int c, const MetricById& metrics) {
  CheckpointValue v;
  v.metric = metrics.at(row.getColumn(c++).getInt64());
  readMembers(externalValueTable(), row, c, v);
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
  InsertOf(db, externalMetricTable(), {"registered_utc"})(metric, {nowUtc()});
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
                                           externalColumns(), newest));
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
                      externalColumns(), newest));
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
    InsertOf(db, externalValueTable(), {"attempt", "metric"})(v, {attempt, metric});
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
