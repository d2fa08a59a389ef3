// SPDX-License-Identifier: GPL-3.0-or-later
// calot study: two groups side by side, of a cohort or of a table from elsewhere.
#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "analytics/cohort/withdraw.h"
#include "analytics/report/study_output.h"
#include "analytics/report/study_tables.h"
#include "apps/calot/commands.h"
#include "apps/calot/report_files.h"
#include "apps/calot/study_options.h"
#include "apps/common/advice.h"
#include "apps/common/exit_code.h"
#include "recorder/errors.h"
#include "recorder/formats/text_output.h"

namespace calot::apps {
namespace {

struct ParsedStudyOptions {
  StudySource source;
  std::string csv, html, pdf;
  bool json = false, force = false, all = false;
};

/// Notes in the cohort whose attempts went into files: a withdrawal lists them.
void noteExports(const ParsedStudyOptions& options, const analytics::Study& study) {
  const std::vector<std::pair<std::string, std::string>> written{
      {"study-csv", options.csv}, {"study-html", options.html}, {"study-pdf", options.pdf}};
  const auto named = [](const auto& file) { return !file.second.empty(); };
  if (options.source.database.empty() || std::none_of(written.begin(), written.end(), named)) return;
  std::set<std::string> units;
  for (const analytics::StudyRow& row : study.rows) {
    for (const auto& group : row.participants) units.insert(group.begin(), group.end());
  }
  const bool masked = study.protocol && study.protocol->masked;  // names nobody: any attempt may be in it
  std::vector<std::string> attempts;
  const analytics::CohortDatabase database(options.source.database, analytics::CohortDatabase::Access::read);
  for (const analytics::AttemptRow& a : database.listAttempts()) {
    if (masked || units.count(a.participant.empty() ? "attempt " + a.uuid : a.participant) > 0)
      attempts.push_back(a.uuid);
  }
  try {
    for (const auto& [kind, file] : written) {
      if (!file.empty()) analytics::recordExport(options.source.database, kind, file, attempts);
    }
  } catch (const Error& e) {
    std::cerr << "calot: warning: what was written is not noted for withdrawals: " << messageOf(e) << '\n';
  }
}

void print(const analytics::Study& study, bool all) {
  analytics::printStudy(study, std::cout, all ? analytics::StudyDetail::all : analytics::StudyDetail::first);
  if (all) return;
  const auto others = std::count_if(study.rows.begin(), study.rows.end(), [](const analytics::StudyRow& row) {
    return !row.leading && !analytics::hasNoValue(row);
  });
  std::cout << fmt::format("{} more figures, and the methods: --all; as a report: --pdf, --html\n", others);
}

}  // namespace

void addStudy(CLI::App& app, Run& run) {
  const auto options = std::make_shared<ParsedStudyOptions>();
  CLI::App* command = app.add_subcommand("study", "Compare two groups of a cohort, or of a table from elsewhere");
  addStudySource(*command, options->source);
  command->add_flag("--masked", options->source.masked,
                    "Call the protocol's groups \"group 1\" and \"group 2\" until its analysis is locked");
  command->add_flag("--json", options->json, "Print JSON");
  command->add_flag("--all", options->all, "Print every figure and the methods, not only the first result");
  command->add_option("--csv", options->csv, "Write study.csv, values.csv, flow.csv and coverage.csv into this folder");
  command->add_option("--html", options->html, "Write one self-contained page with figures");
  addPdfOption(*command, options->pdf, "Write the same on A4 pages");
  command->add_flag("--force", options->force, "Replace files that are there");
  command->callback([options, &run] {
    run = [options] {
      for (const std::string& file : {options->html, options->pdf}) {
        if (!file.empty()) recorder::refuseOutput(file, options->force);
      }
      const analytics::Study study = studyOf(options->source);
      if (!options->csv.empty()) analytics::writeStudyCsv(study, options->csv, options->force);
      writeReport(analytics::studyDocument(study), options->html, options->pdf, options->force);
      noteExports(*options, study);
      if (options->json) {
        std::cout << analytics::studyJson(study) << '\n';
      } else {
        print(study, options->all);
      }
      return static_cast<int>(ExitCode::yes);
    };
  });
}

}  // namespace calot::apps
