// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/interchange/codebook.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "analytics/checkpoints/checkpoint.h"
#include "recorder/attempt.h"
#include "recorder/base/csv_writer.h"

namespace calot::analytics {
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

}  // namespace calot::analytics
