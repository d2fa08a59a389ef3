// SPDX-License-Identifier: GPL-3.0-or-later
// Values of checkpoints, their intervals, and external metrics with their values.

#include <fmt/format.h>
#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <utility>

#include "analytics/cohort/tables.h"

namespace calot::analytics::tables {

std::vector<CheckpointValue> readValues(SQLite::Database& db, std::int64_t id) {
  return selectRows(db, checkpointValueTable, "WHERE attempt = ? ORDER BY position", {id});
}

bool replaceValues(SQLite::Database& db, std::int64_t id, const std::vector<CheckpointValue>& values) {
  std::vector<CheckpointValue> before = readValues(db, id);
  if (before == values) return false;
  const std::int64_t end =
      firstNumber(db, "SELECT coalesce(max(position) + 1, 0) FROM checkpoint_value WHERE attempt = ?", {id});
  if (end != static_cast<std::int64_t>(before.size())) {  // a gap: row i is not at position i
    execute(db, "DELETE FROM checkpoint_value WHERE attempt = ?", {id});
    before.clear();
  }
  // Rows that stay as they are, are not written. Those that go first: a value that moved would meet its old row.
  const auto same = [&](std::size_t i) { return i < before.size() && i < values.size() && before[i] == values[i]; };
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (same(i)) continue;
    execute(db, "DELETE FROM checkpoint_value WHERE attempt = ? AND position = ?", {id, static_cast<std::int64_t>(i)});
  }
  InsertOf put(db, checkpointValueTable, {"attempt", "position"});
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!same(i)) put(values[i], {id, static_cast<std::int64_t>(i)});
  }
  return true;
}

void readAllValues(SQLite::Database& db, const std::vector<std::string>& without,
                   const std::function<void(const AttemptValue&)>& take) {
  const std::vector<Cell> names(without.begin(), without.end());
  // Most cohorts have no intervals; looking for one beside each value costs as much as reading the values.
  const bool intervals = firstNumber(db, "SELECT EXISTS (SELECT 1 FROM value_interval)") != 0;
  AttemptValue value;
  eachRow(db,
          fmt::format("SELECT a.uuid, {}{} FROM checkpoint_value c JOIN attempt a ON a.id = c.attempt {} "
                      "WHERE c.name NOT IN ({}) ORDER BY a.uuid, c.position",
                      memberColumns(checkpointValueTable, "c"),
                      intervals ? ", i.attempt, " + memberColumns(valueIntervalTable, "i") : "",
                      intervals ? "LEFT JOIN value_interval i ON " + intervalIsOfValue() : "",
                      joined(std::vector<std::string>(names.size(), "?"), ", ")),
          names, [&](SQLite::Statement& row) {
            int c = 0;
            value.attempt = text(row.getColumn(c++));
            readMembers(checkpointValueTable, row, c, value.value);
            value.interval.reset();
            if (intervals && !row.getColumn(c++).isNull())
              readMembers(valueIntervalTable, row, c, value.interval.emplace());
            take(value);
          });
}

std::map<std::string, CheckpointValue> readValuesOf(SQLite::Database& db, std::string_view checkpoint) {
  std::map<std::string, CheckpointValue> values;
  eachRow(db,
          fmt::format("SELECT a.uuid, {} FROM checkpoint_value c JOIN attempt a ON a.id = c.attempt WHERE c.name = ?",
                      memberColumns(checkpointValueTable, "c")),
          {std::string(checkpoint)}, [&](SQLite::Statement& row) {
            int c = 1;
            readMembers(checkpointValueTable, row, c, values[text(row.getColumn(0))]);
          });
  return values;
}

std::string intervalIsOfValue() {
  return fmt::format(
      "i.attempt = c.attempt AND i.name = c.name AND i.subject = c.subject AND i.version = c.version AND "
      "i.value = c.value AND i.method = {}",
      intervalMethod);
}

std::vector<ValueInterval> readIntervals(SQLite::Database& db, std::int64_t id) {
  std::vector<ValueInterval> intervals;
  eachRow(db,
          fmt::format("SELECT {} FROM value_interval i JOIN checkpoint_value c ON {} WHERE c.attempt = ? "
                      "ORDER BY c.position",
                      memberColumns(valueIntervalTable, "i"), intervalIsOfValue()),
          {id}, [&](SQLite::Statement& row) {
            int c = 0;
            readMembers(valueIntervalTable, row, c, intervals.emplace_back());
          });
  return intervals;
}

bool replaceIntervals(SQLite::Database& db, std::int64_t id, const std::vector<ValueInterval>& intervals) {
  if (readIntervals(db, id) == intervals) return false;
  execute(db, "DELETE FROM value_interval WHERE attempt = ?", {id});
  InsertOf put(db, valueIntervalTable, {"attempt", "method"});
  for (const ValueInterval& i : intervals) put(i, {id, std::int64_t{intervalMethod}});
  return true;
}

namespace {

using MetricById = std::map<std::int64_t, ExternalMetricRef>;

/// Each is one object, which its values share.
MetricById metricsById(SQLite::Database& db) {
  MetricById metrics;
  eachRow(db, fmt::format("SELECT id, {} FROM external_metric", memberColumns(externalMetricTable)), {},
          [&](SQLite::Statement& row) {
            ExternalMetric m;
            int c = 1;
            readMembers(externalMetricTable, row, c, m);
            CheckpointDefinition& d = m.definition;
            d.displayUnit = d.unit;
            d.window = "whole attempt";
            d.filter = "none";
            d.origins = {Origin::external};
            d.finality = Finality::final;
            d.definition = "script with SHA-256 " + m.sha256;
            metrics.emplace(row.getColumn(0).getInt64(), ExternalMetricRef(std::move(m)));
          });
  return metrics;
}

/// Values of external metrics of the newest version of their name, by attempt and name.
/// @param condition on rows of external_value (alias e), metric (m) and attempt (a)
std::vector<AttemptValue> externalValues(SQLite::Database& db, const std::string& condition,
                                         const std::vector<Cell>& parameters) {
  const MetricById metrics = metricsById(db);
  std::vector<AttemptValue> values;
  if (metrics.empty()) return values;
  eachRow(db,
          fmt::format("SELECT a.uuid, e.metric, {} FROM external_value e JOIN external_metric m ON m.id = e.metric "
                      "JOIN attempt a ON a.id = e.attempt WHERE {} AND NOT EXISTS (SELECT 1 FROM external_value l JOIN "
                      "external_metric n ON n.id = l.metric WHERE l.attempt = e.attempt AND n.name = m.name AND "
                      "n.version > m.version) ORDER BY a.uuid, m.name",
                      memberColumns(externalValueTable, "e"), condition),
          parameters, [&](SQLite::Statement& row) {
            CheckpointValue v;
            v.metric = metrics.at(row.getColumn(1).getInt64());
            int c = 2;
            readMembers(externalValueTable, row, c, v);
            const CheckpointDefinition& d = v.metric->definition;
            v.name = d.name;
            v.version = d.version;
            v.unit = d.unit;
            v.origin = Origin::external;
            v.filter = d.filter;
            values.push_back({text(row.getColumn(0)), std::move(v), {}});
          });
  return values;
}

std::int64_t registered(SQLite::Database& db, const std::string& path, const ExternalMetric& metric) {
  checkExternalMetric(db, path, metric);
  const CheckpointDefinition& d = metric.definition;
  const std::int64_t known =
      firstNumber(db, "SELECT id FROM external_metric WHERE name = ? AND version = ?", {d.name, d.version});
  if (known >= 0) return known;
  InsertOf(db, externalMetricTable, {"registered_utc"})(metric, {nowUtc()});
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
  for (const ExternalMetric& known : selectRows(
           db, externalMetricTable, "WHERE name = ? AND version >= ? ORDER BY version DESC", {d.name, d.version})) {
    const std::uint32_t version = known.definition.version;
    if (version > d.version) {
      throw Error(ErrorKind::refused,
                  fmt::format("{} is version {}, {} has version {} already", d.name, d.version, path, version));
    }
    if (known.sha256 != metric.sha256) {
      throw Error(ErrorKind::refused, fmt::format("{} version {} was another text when {} took it in; raise VERSION",
                                                  d.name, version, path));
    }
  }
}

std::vector<CheckpointValue> readExternalValues(SQLite::Database& db, std::int64_t attempt) {
  std::vector<CheckpointValue> values;
  for (AttemptValue& v : externalValues(db, "e.attempt = ?", {attempt})) values.push_back(std::move(v.value));
  return values;
}

std::vector<AttemptValue> readAllExternalValues(SQLite::Database& db, const std::vector<std::string>& without) {
  return externalValues(db,
                        fmt::format("m.name NOT IN ({})", joined(std::vector<std::string>(without.size(), "?"), ", ")),
                        {without.begin(), without.end()});
}

std::size_t writeExternalValues(SQLite::Database& db, const std::string& path, std::int64_t attempt,
                                const std::vector<CheckpointValue>& values) {
  std::size_t added = 0;
  for (const CheckpointValue& v : values) {
    const std::int64_t metric = registered(db, path, *v.metric);
    const auto known = selectRows(db, externalValueTable, "WHERE attempt = ? AND metric = ?", {attempt, metric});
    if (known.empty()) {
      InsertOf(db, externalValueTable, {"attempt", "metric"})(v, {attempt, metric});
      ++added;
      continue;
    }
    const CheckpointValue& before = known.front();
    if (before.value == v.value && before.reason == v.reason && before.note == v.note) continue;
    throw Error(ErrorKind::refused,
                fmt::format("{} version {} gave {} of this attempt before and gives {} now; a metric gives the same "
                            "value each time, or raise VERSION",
                            v.name, v.version, shownValue(before.value), shownValue(v.value)));
  }
  return added;
}

}  // namespace calot::analytics::tables
