// SPDX-License-Identifier: GPL-3.0-or-later
// External metrics and their values (schemas/cohort/0008_external.sql).
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "analytics/cohort/connection.h"
#include "analytics/cohort/tables.h"

namespace calot::analytics::tables {
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
