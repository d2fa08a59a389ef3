// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/cohort_exports.h"

#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "analytics/interchange/cohort_bundle.h"
#include "analytics/interchange/cohort_tables.h"
#include "apps/calot/cohort_option.h"
#include "apps/calot/results.h"
#include "apps/common/exit_code.h"
#include "recorder/base/errors.h"

namespace calot::apps {
namespace {

using Json = nlohmann::ordered_json;

struct CohortExportsOptions {
  std::string cohort, folder;
  analytics::BundleOptions bundle;
  bool json = false, force = false;
};

int exportTables(const CohortExportsOptions& o) {
  const std::vector<analytics::ExportedTable> tables = analytics::exportCohort(o.cohort, o.folder, o.force);
  Json list = Json::array();
  for (const analytics::ExportedTable& t : tables) {
    if (o.json) {
      list.push_back({{"table", t.name}, {"rows", t.rows}});
    } else {
      std::cout << fmt::format("{:<24}{} rows\n", t.name, t.rows);
    }
  }
  if (o.json) printResult("cohort-export", {{"tables", list}});
  return static_cast<int>(ExitCode::yes);
}

int handOut(const CohortExportsOptions& o) {
  const analytics::Bundle b = analytics::writeBundle(o.cohort, o.folder, o.bundle, o.force);
  if (o.json) {
    Json left = Json::array(), files = Json::array();
    for (const auto& row : b.leftOut) left.push_back({{"reason", row.reason}, {"attempts", row.attempts}});
    for (const auto& f : b.files) files.push_back({{"name", f.name}, {"bytes", f.bytes}, {"sha256", f.sha256}});
    const Json all{{"participants", b.participants},
                   {"attempts", b.attempts},
                   {"values", b.values},
                   {"recruited", b.recruited},
                   {"left_out", left},
                   {"smallest_group", b.smallest},
                   {"files", files}};
    printResult("cohort-bundle", all);
    return static_cast<int>(ExitCode::yes);
  }
  std::cout << fmt::format("{}: {} of {} attempts, of {} participants, {} values\n", o.folder, b.attempts, b.recruited,
                           b.participants, b.values);
  for (const auto& row : b.leftOut) std::cout << fmt::format("{} attempts left out: {}\n", row.attempts, row.reason);
  if (b.participants > 0)
    std::cout << fmt::format(
        "The smallest group that shares group, arm and site is of {}: look whether its members "
        "can be known by that and their experience.\n",
        b.smallest);
  return static_cast<int>(ExitCode::yes);
}

CLI::App* addOne(CLI::App& parent, Run& run, const char* name, const char* help,
                 const std::shared_ptr<CohortExportsOptions>& o, int (*work)(const CohortExportsOptions&)) {
  CLI::App* command = parent.add_subcommand(name, help);
  addCohortOption(*command, o->cohort)->required();
  command->add_option("-o,--output", o->folder, "Folder to make")->required();
  command->add_flag("--force", o->force, "Replace a folder of this name that holds no other files");
  command->add_flag("--json", o->json, "Print JSON");
  command->callback([o, work, &run] { run = [o, work] { return work(*o); }; });
  return command;
}

}  // namespace

void addCohortExports(CLI::App& parent, Run& run) {
  addOne(parent, run, "export", "Write every table as CSV and JSON, with a codebook; names and dates as they are",
         std::make_shared<CohortExportsOptions>(), exportTables);
  const auto o = std::make_shared<CohortExportsOptions>();
  CLI::App* bundle =
      addOne(parent, run, "bundle", "Write what was measured for others, de-identified, with a manifest", o, handOut);
  bundle->add_option("--scope", o->bundle.scope, "Purpose to which participants have consented; others stay out")
      ->capture_default_str();
  bundle->add_flag("--include-synthetic", o->bundle.includeSynthetic, "Take in what performers made");
}

}  // namespace calot::apps
