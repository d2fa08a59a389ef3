// SPDX-License-Identifier: GPL-3.0-or-later
// The codebook against what it explains: the registry, the database's schema, the files that are written.
#include "analytics/interchange/export_tables.h"

#include <gtest/gtest.h>
#include <SQLiteCpp/SQLiteCpp.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "analytics/cohort/tables.h"
#include "recorder/base/csv.h"
#include "tests/analytics/cohort/support/cohort_support.h"
#include "tests/support/fault.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using Access = CohortDatabase::Access;
using nlohmann::json;
using support::Folder;
using support::humanAttempt;
using support::valuesOf;

json jsonOf(const std::string& path) {
  std::ifstream file(path);
  return json::parse(file);
}

TEST(Codebook, hasEveryCheckpointAsTheRegistryDeclaresIt) {
  const std::vector<CodebookEntry> entries = checkpointEntries();
  const auto& registry = checkpointRegistry();
  ASSERT_EQ(entries.size(), registry.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const CheckpointDefinition& d = registry[i].definition;
    const CodebookEntry& e = entries[i];
    EXPECT_EQ(e.name, d.name);
    EXPECT_EQ(e.unit, d.unit);
    EXPECT_EQ(e.direction, nameOf(d.direction));
    EXPECT_EQ(e.window, d.window);
    EXPECT_EQ(e.version, d.version);
    EXPECT_EQ(e.formula, d.definition);
    EXPECT_EQ(e.filter, d.filter);
    for (const std::string* part : {&e.title, &e.unit, &e.window, &e.formula, &e.subjects, &e.origins, &e.missing})
      EXPECT_FALSE(part->empty()) << e.name;
  }
}

TEST(Codebook, explainsEveryColumnOfTheSchemaAndNoOther) {
  const Folder folder;
  const std::string path = folder.file("c.db");
  { const CohortDatabase made(path, Access::create); }
  SQLite::Database raw(path, SQLite::OPEN_READONLY);
  std::set<std::pair<std::string, std::string>> schema, explained;
  std::set<std::string> tables;
  for (const TableFacts& table : readTables(raw)) {
    tables.insert(table.name);
    for (const ColumnFacts& c : table.columns) schema.emplace(table.name, c.name);
  }
  for (const DeclaredTable* table : cohortTables()) {
    for (const DeclaredColumn& c : table->columns) {
      EXPECT_STRNE(c.meaning, "") << table->name << "." << c.name;
      EXPECT_TRUE(explained.emplace(table->name, c.name).second) << table->name << "." << c.name << " twice";
    }
  }
  EXPECT_EQ(schema, explained);
}

TEST(Codebook, everyFormSaysTheSame) {
  std::vector<CodebookEntry> entries = checkpointEntries();
  for (CodebookEntry& e :
       columnEntries(TableFacts{"attempt", {{"seed", "TEXT"}, {"steps", "INTEGER"}, {"unheard", "BLOB"}}, {}, "", {}}))
    entries.push_back(e);
  const CsvTable csv = parseCsvTable(codebookCsv(entries), "codebook.csv");
  const json variables = json::parse(codebookJson(entries)).at("variables");
  ASSERT_EQ(csv.rows.size(), entries.size());
  ASSERT_EQ(variables.size(), entries.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    EXPECT_EQ(csv.rows[i].cells[csv.column("name")], entries[i].name);
    EXPECT_EQ(variables[i].at("name"), entries[i].name);
    EXPECT_EQ(variables[i].at("type"), csv.rows[i].cells[csv.column("type")]);
    EXPECT_EQ(variables[i].contains("formula"), entries[i].version > 0);
  }
  expectNames(entries.back().type, {"hexadecimal"});
  EXPECT_EQ(entries.back().title, "") << "what nobody has explained stays without a word";
}

TEST(CohortTables, giveEveryRowBackBothWays) {
  const Folder folder;
  const std::string path = folder.file("c.db"), out = folder.file("out");
  {
    CohortDatabase database(path, Access::create);
    database.addParticipant({"=P1", "expert", "", "north", {{"level", "a, \"b\""}}, {}});
    AttemptRecord a = humanAttempt(1, "=P1");
    a.signature.emplace().publicKey[0] = std::byte{0xAB};
    database.storeAttempt(a, valuesOf(0.1 + 0.2, 1.0 / 3.0));
  }
  const std::vector<ExportedTable> tables = exportCohort(path, out);
  SQLite::Database raw(path, SQLite::OPEN_READONLY);
  std::set<std::string> names;
  for (const TableFacts& table : readTables(raw)) names.insert(table.name);
  for (const DeclaredTable& view : cohortViews()) names.insert(view.name);
  ASSERT_EQ(tables.size(), names.size());
  for (const ExportedTable& t : tables) {
    EXPECT_EQ(names.count(t.name), 1U);
    EXPECT_EQ(jsonOf(out + "/" + t.name + ".json").size(), t.rows) << t.name;
    const std::string csv = out + "/" + t.name + ".csv";
    if (t.rows == 0) {  // which is no table to the reader
      std::ifstream file(csv);
      EXPECT_EQ(std::count(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>(), '\n'), 1) << t.name;
    } else {
      EXPECT_EQ(readCsvTable(csv).rows.size(), t.rows) << t.name;
    }
  }
  const json values = jsonOf(out + "/checkpoint_value.json");
  ASSERT_EQ(values.size(), 3U);
  EXPECT_EQ(values[0].at("value").get<double>(), 0.1 + 0.2) << "to the last bit";
  EXPECT_TRUE(values[2].at("value").is_null());
  const CsvTable csv = readCsvTable(out + "/checkpoint_value.csv");
  EXPECT_EQ(std::stod(csv.rows[1].cells[csv.column("value")]), 1.0 / 3.0);
  EXPECT_EQ(csv.rows[2].cells[csv.column("value")], "");
  EXPECT_EQ(jsonOf(out + "/participant.json")[0].at("pseudonym"), "=P1");
  const CsvTable people = readCsvTable(out + "/participant.csv");
  EXPECT_EQ(people.rows[0].cells[people.column("pseudonym")], "'=P1") << "no formula for a spreadsheet";
  EXPECT_EQ(jsonOf(out + "/participant_experience.json")[0].at("value"), "a, \"b\"");
  EXPECT_EQ(jsonOf(out + "/recording_signature.json")[0].at("public_key").get<std::string>().substr(0, 4), "ab00");
  // Noted for who withdraws.
  EXPECT_EQ(raw.execAndGet("SELECT kind || ' ' || count(*) FROM export JOIN export_attempt ON export = id").getString(),
            "cohort-export 1");
  expectFault(ErrorKind::invalid, out, {}, [&] { (void)exportCohort(path, out); });
  expectFault(ErrorKind::invalid, folder.file("no/out"), {folder.file("no")},
              [&] { (void)exportCohort(path, folder.file("no/out")); });
  expectFault(ErrorKind::damaged, folder.file("n.db"), {},
              [&] { (void)exportCohort(folder.file("n.db"), folder.file("o")); });
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(path).parent_path()))
    EXPECT_EQ(entry.path().string().find(".part"), std::string::npos) << entry.path();
}

}  // namespace
}  // namespace calot::analytics
