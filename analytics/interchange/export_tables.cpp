// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/interchange/export_tables.h"

#include <fmt/format.h>
#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/hand_motion.h"
#include "analytics/cohort/tables.h"
#include "analytics/cohort/withdraw.h"
#include "analytics/interchange/folder_output.h"
#include "recorder/base/csv.h"
#include "recorder/base/files.h"
#include "recorder/loop.h"

namespace calot::analytics {
namespace {

using Json = nlohmann::ordered_json;

Json jsonOf(const Cell& cell) {
  if (const auto* s = std::get_if<std::string>(&cell)) return *s;
  if (const auto* i = std::get_if<std::int64_t>(&cell)) return *i;
  if (const auto* d = std::get_if<double>(&cell)) return *d;
  if (const auto* b = std::get_if<Blob>(&cell)) return recorder::hexOf(*b);
  return nullptr;
}

std::string csvOf(const Cell& cell) {
  if (const auto* s = std::get_if<std::string>(&cell)) return csvCell(*s);
  if (const auto* b = std::get_if<Blob>(&cell)) return recorder::hexOf(*b);
  return std::holds_alternative<std::monostate>(cell) ? "" : shownCell(cell);
}

std::string csvOf(const TableFacts& table, const std::vector<Row>& rows) {
  std::vector<std::string> names;
  for (const ColumnFacts& c : table.columns) names.push_back(c.name);
  std::string text = csvLine(names);
  for (const Row& row : rows) {
    for (const ColumnFacts& c : table.columns) {
      text += csvOf(row.at(c.name));
      text += ',';
    }
    text.back() = '\n';
  }
  return text;
}

/// A row a line, so that large tables can be looked through.
std::string jsonOf(const TableFacts& table, const std::vector<Row>& rows) {
  std::string text = "[";
  for (const Row& row : rows) {
    Json object = Json::object();
    for (const ColumnFacts& c : table.columns) object[c.name] = jsonOf(row.at(c.name));
    text += text.size() == 1 ? "\n" : ",\n";
    text += object.dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  return text + "\n]\n";
}

}  // namespace

std::vector<ExportedTable> exportCohort(const std::string& database, const std::string& folder, bool force) {
  FolderOutput output(folder, force);
  std::vector<ExportedTable> written;
  std::vector<std::string> attempts;
  CohortConnection(database, CohortDatabase::Access::read).read([&](SQLite::Database& db) {
    SQLite::Transaction reading(db);
    std::vector<CodebookEntry> entries;
    const auto add = [&](const TableFacts& table, std::vector<CodebookEntry> explained) {
      const std::vector<Row> rows = readRows(db, table);
      output.add(table.name + ".csv", csvOf(table, rows));
      output.add(table.name + ".json", jsonOf(table, rows));
      std::move(explained.begin(), explained.end(), std::back_inserter(entries));
      written.push_back({table.name, rows.size()});
    };
    for (const TableFacts& table : readTables(db)) add(table, columnEntries(table));
    for (const DeclaredTable& view : cohortViews()) {
      TableFacts facts;
      facts.name = view.name;
      for (const DeclaredColumn& c : view.columns) {
        facts.columns.push_back({c.name, c.type});
        if (std::set<std::string>{"attempt", "name", "subject"}.count(c.name) > 0) facts.key.emplace_back(c.name);
      }
      add(facts, columnEntries(view));
    }
    for (CodebookEntry& e : checkpointEntries(tables::readExternalMetrics(db))) entries.push_back(std::move(e));
    output.add("codebook.csv", codebookCsv(entries));
    output.add("codebook.json", codebookJson(entries));
    attempts = firstTexts(db, "SELECT uuid FROM attempt");
  });
  recordExport(database, "cohort-export", folder, attempts);
  output.finish();
  return written;
}

namespace {

std::string typeWord(const std::string& type) {
  if (type.rfind("INTEGER", 0) == 0) return "whole number";
  if (type.rfind("REAL", 0) == 0) return "number";
  return type.rfind("BLOB", 0) == 0 ? "bytes in hexadecimal" : "text";
}

/// Entries shared by checkpoints and external metrics.
CodebookEntry entryOf(const CheckpointDefinition& d) {
  return {.table = "checkpoint",
          .name = d.name,
          .title = d.title,
          .type = "number",
          .unit = d.unit,
          .allowed = "finite",
          .direction = nameOf(d.direction),
          .window = d.window,
          .filter = d.filter,
          .version = d.version};
}

}  // namespace

std::vector<CodebookEntry> checkpointEntries(const std::vector<ExternalMetric>& external) {
  std::vector<CodebookEntry> entries;
  for (const CheckpointEntry& known : checkpointRegistry()) {
    const CheckpointDefinition& d = known.definition;
    CodebookEntry e = entryOf(d);
    e.missing =
        "availability 1: the question has no answer for this attempt; 2: what is recorded does not give it; 3: the "
        "hand has no instrument; 4: samples cover too little; the value is empty and a reason stands beside it";
    if (d.minCoverage > 0.0) e.missing += fmt::format("; coverage wanted: {}", coverageText(d));
    e.subjects = fmt::format("each {}{}{}", nameOf(d.aggregation), d.instruments.empty() ? "" : "; ", d.instruments);
    e.formula = d.definition;
    for (const Origin origin : d.origins) e.origins += (e.origins.empty() ? "" : ", ") + nameOf(origin);
    entries.push_back(std::move(e));
  }
  for (const ExternalMetric& metric : external) {
    const CheckpointDefinition& d = metric.definition;
    CodebookEntry e = entryOf(d);
    e.missing = "availability 2: the script gave none; the value is empty and a reason stands beside it";
    e.subjects = "each attempt";
    e.formula = "a script of the site, SHA-256 " + metric.sha256;
    e.origins = nameOf(Origin::external);
    entries.push_back(std::move(e));
  }
  return entries;
}

std::vector<CodebookEntry> columnEntries(const DeclaredTable& table) {
  std::vector<CodebookEntry> entries;
  for (const DeclaredColumn& c : table.columns) {
    entries.push_back({.table = table.name,
                       .name = c.name,
                       .title = c.meaning,
                       .type = typeWord(c.type),
                       .unit = c.unit,
                       .allowed = c.allowed,
                       .missing = c.missing});
  }
  return entries;
}

std::vector<CodebookEntry> columnEntries(const TableFacts& table) {
  DeclaredTable declared{table.name.c_str(), {}};
  for (const ColumnFacts& c : table.columns) {
    const DeclaredColumn* known = findColumn(table.name, c.name);
    declared.columns.push_back(known != nullptr ? *known : DeclaredColumn{c.name.c_str(), c.type.c_str(), ""});
  }
  return columnEntries(declared);
}

std::string codebookCsv(const std::vector<CodebookEntry>& entries) {
  std::string text = csvLine({"table", "name", "title", "type", "unit", "allowed", "missing", "direction", "window",
                              "subjects", "formula", "filter", "origins", "version"});
  for (const CodebookEntry& e : entries) {
    text += csvLine({e.table, e.name, e.title, e.type, e.unit, e.allowed, e.missing, e.direction, e.window, e.subjects,
                     e.formula, e.filter, e.origins, e.version == 0 ? "" : fmt::format("{}", e.version)});
  }
  return text;
}

std::string codebookJson(const std::vector<CodebookEntry>& entries) {
  using Json = nlohmann::ordered_json;
  Json variables = Json::array();
  for (const CodebookEntry& e : entries) {
    Json variable{{"table", e.table}, {"name", e.name},       {"title", e.title},    {"type", e.type},
                  {"unit", e.unit},   {"allowed", e.allowed}, {"missing", e.missing}};
    if (e.version > 0) {
      variable.update(Json{{"direction", e.direction},
                           {"window", e.window},
                           {"subjects", e.subjects},
                           {"formula", e.formula},
                           {"filter", e.filter},
                           {"origins", e.origins},
                           {"version", e.version}});
    }
    variables.push_back(std::move(variable));
  }
  return Json{{"format", "calot-codebook"},
              {"formatVersion", 1},
              {"made_by", recorder::softwareName()},
              {"variables", variables}}
             .dump(1, ' ', false, Json::error_handler_t::replace) +
         "\n";
}

namespace {

double timeOf(std::int64_t point) { return static_cast<double>(point) / motionRate; }

double timeOf(const MotionSegment& segment, std::size_t i) {
  return timeOf(segment.first + static_cast<std::int64_t>(i));
}

std::string pointsTable(const Motion& motion) {
  bool oriented = !motion.segments.empty();
  for (const MotionSegment& segment : motion.segments) oriented = oriented && !segment.orientation.empty();
  std::string text = "time (s),segment,x (m),y (m),z (m),";
  if (oriented) text += "orientation_w,orientation_x,orientation_y,orientation_z,";
  text += "speed (m/s),unfiltered_x (m),unfiltered_y (m),unfiltered_z (m),movement\n";
  const auto out = std::back_inserter(text);
  std::size_t number = 0, movement = 0;
  for (const MotionSegment& segment : motion.segments) {
    ++number;
    const std::vector<Stretch> movements = movementsOf(segment, motion.movementSpeed);
    std::size_t next = 0;
    for (std::size_t i = 0; i < segment.filtered.size(); ++i) {
      while (next < movements.size() && i >= movements[next].end) ++next;
      const Vec3 &p = segment.filtered[i], &raw = segment.raw[i];
      fmt::format_to(out, "{},{},{},{},{},", timeOf(segment, i), number, p.x(), p.y(), p.z());
      if (oriented) {
        const Quat& q = segment.orientation[i];
        fmt::format_to(out, "{},{},{},{},", q.w(), q.x(), q.y(), q.z());
      }
      fmt::format_to(out, "{},{},{},{},", segment.speed[i], raw.x(), raw.y(), raw.z());
      if (next < movements.size() && i >= movements[next].begin) fmt::format_to(out, "{}", movement + next + 1);
      text += '\n';
    }
    movement += movements.size();
  }
  return text;
}

void addSpans(std::string& text, const char* hand, const Motion& motion) {
  const auto out = std::back_inserter(text);
  const auto add = [&](const char* kind, std::size_t number, double begin, double end, const char* afterGap) {
    fmt::format_to(out, "{},{},{},{},{},{}\n", hand, kind, number, begin, end, afterGap);
  };
  std::size_t number = 0;
  for (const TimeSpan& span : motion.coverage.mounted) add("mounted", ++number, span.begin, span.end, "");
  number = 0;
  for (const TimeSpan& span : motion.coverage.lost) add("lost", ++number, span.begin, span.end, "");
  number = 0;
  for (const MotionSegment& s : motion.segments)
    add("segment", ++number, timeOf(s, 0), timeOf(s, s.filtered.size()), s.continues ? "true" : "false");
  number = 0;
  for (const MotionSegment& s : motion.segments) {
    for (const Stretch& m : movementsOf(s, motion.movementSpeed))
      add("movement", ++number, timeOf(s, m.begin), timeOf(s, m.end), "");
  }
}

nlohmann::ordered_json treeOfMotion(const Motion& motion) {
  nlohmann::ordered_json summary{{"mounted", motion.mounted}};
  const std::optional<double> share = motion.coverage.share();
  summary["coverage"] = share ? nlohmann::ordered_json(*share) : nlohmann::ordered_json(nullptr);
  summary["sample_rate_hz"] = motion.rate;
  summary["noise_m"] = motion.noise ? nlohmann::ordered_json(*motion.noise) : nlohmann::ordered_json(nullptr);
  summary["sample_interval_s"] = motion.interval;
  summary["movement_threshold_m_s"] = motion.movementSpeed;
  summary["points"] = motion.points();
  return summary;
}

}  // namespace

std::vector<std::filesystem::path> writeMotionTables(const std::array<Motion, handCount>& motion,
                                                     const std::filesystem::path& folder, bool force) {
  FolderOutput output(folder, force);
  std::string spans = "hand,kind,number,begin (s),end (s),after_gap\n";
  nlohmann::ordered_json summary{
      {"rate_hz", motionRate}, {"cutoff_hz", motion[0].cutoff}, {"filter", motionFilterText(motion[0].cutoff)}};
  for (std::size_t h = 0; h < motion.size(); ++h) {
    const char* hand = handNames[h];
    output.add(fmt::format("motion_{}.csv", hand), pointsTable(motion[h]));
    addSpans(spans, hand, motion[h]);
    summary[hand] = treeOfMotion(motion[h]);
  }
  output.add("spans.csv", spans);
  output.add("motion.json", summary.dump(2) + "\n");
  output.finish();
  std::vector<std::filesystem::path> files;
  for (const WrittenFile& file : output.files()) files.push_back(folder / file.name);
  return files;
}

}  // namespace calot::analytics
