// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/interchange/cohort_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "analytics/cohort/any_table.h"
#include "analytics/cohort/connection.h"
#include "analytics/cohort/tables.h"
#include "analytics/cohort/withdraw.h"
#include "analytics/interchange/codebook.h"
#include "analytics/interchange/folder_output.h"
#include "recorder/base/csv_writer.h"

namespace calot::analytics {
namespace {

using Json = nlohmann::ordered_json;

Json jsonOf(const Cell& cell) {
  if (const auto* s = std::get_if<std::string>(&cell)) return *s;
  if (const auto* i = std::get_if<std::int64_t>(&cell)) return *i;
  if (const auto* d = std::get_if<double>(&cell)) return *d;
  if (const auto* b = std::get_if<Blob>(&cell)) return hexOf(*b);
  return nullptr;
}

std::string csvOf(const Cell& cell) {
  if (const auto* s = std::get_if<std::string>(&cell)) return csvCell(*s);
  if (const auto* b = std::get_if<Blob>(&cell)) return hexOf(*b);
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
    for (const TableFacts& table : readTables(db)) {
      const std::vector<Row> rows = readRows(db, table);
      output.add(table.name + ".csv", csvOf(table, rows));
      output.add(table.name + ".json", jsonOf(table, rows));
      for (CodebookEntry& e : columnEntries(table)) entries.push_back(std::move(e));
      written.push_back({table.name, rows.size()});
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

}  // namespace calot::analytics
