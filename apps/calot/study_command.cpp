// SPDX-License-Identifier: GPL-3.0-or-later
// calot study: groups side by side and the other designs, of a cohort or of a table from elsewhere.
#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "analytics/cohort/check.h"
#include "analytics/cohort/withdraw.h"
#include "analytics/report/study_output.h"
#include "analytics/report/study_tables.h"
#include "apps/calot/commands.h"
#include "apps/calot/design_options.h"
#include "apps/calot/environment.h"
#include "apps/calot/report_files.h"
#include "apps/calot/results.h"
#include "apps/calot/study_options.h"
#include "apps/common/advice.h"
#include "apps/common/exit_code.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_output.h"

namespace calot::apps {
namespace {

struct ParsedStudyOptions {
  StudySource source;
  DesignOptions design;
  std::string csv, html, pdf;
  bool json = false, force = false, all = false;
};

/// Notes in the cohort that attempts went into files: a withdrawal lists them.
void noteExports(const ParsedStudyOptions& options, const std::vector<std::string>& attempts) {
  const std::vector<std::pair<std::string, std::string>> written{
      {"study-csv", options.csv}, {"study-html", options.html}, {"study-pdf", options.pdf}};
  try {
    for (const auto& [kind, file] : written) {
      if (!file.empty()) analytics::recordExport(options.source.database, kind, file, attempts);
    }
  } catch (const Error& e) {
    std::cerr << "calot: warning: what was written is not noted for withdrawals: " << messageOf(e) << '\n';
  }
}

bool isExported(const ParsedStudyOptions& options) {
  return !options.source.database.empty() && !(options.csv + options.html + options.pdf).empty();
}

/// Attempts of the participants who are in the study's rows.
std::vector<std::string> attemptsIn(const analytics::Study& study, const std::string& path) {
  std::set<std::string> units;
  for (const analytics::StudyRow& row : study.rows) {
    for (const auto& group : row.participants) units.insert(group.begin(), group.end());
  }
  const bool masked = study.protocol && study.protocol->masked;  // names nobody: any attempt may be in it
  std::vector<std::string> attempts;
  const analytics::CohortDatabase database(path, analytics::CohortDatabase::Access::read);
  for (const analytics::AttemptRow& a : database.listAttempts()) {
    if (masked || units.count(a.participant.empty() ? "attempt " + a.uuid : a.participant) > 0)
      attempts.push_back(a.uuid);
  }
  return attempts;
}

void print(const analytics::Study& study, bool all) {
  analytics::printStudy(study, std::cout, all ? analytics::StudyDetail::all : analytics::StudyDetail::first);
  if (all) return;
  const auto others = std::count_if(study.rows.begin(), study.rows.end(), [](const analytics::StudyRow& row) {
    return !row.leading && !analytics::hasNoValue(row);
  });
  std::cout << fmt::format("{} more figures, and the methods: --all; as a report: --pdf, --html\n", others);
}

int runTwoGroups(ParsedStudyOptions& options) {
  Progress progress("computing the study", options.json);
  const analytics::Study study = studyOf(options.source, [&](double share, const char*) { progress.showShare(share); });
  Progress::erase();
  if (!options.csv.empty()) analytics::writeStudyCsv(study, options.csv, options.force);
  writeReport(analytics::studyDocument(study), options.html, options.pdf, options.force);
  if (isExported(options)) noteExports(options, attemptsIn(study, options.source.database));
  if (options.json) {
    printResult("study", nlohmann::ordered_json::parse(analytics::studyJson(study)));
  } else {
    print(study, options.all);
  }
  return static_cast<int>(ExitCode::yes);
}

int runDesign(ParsedStudyOptions& options) {
  if (!options.csv.empty())
    throw Error(ErrorKind::invalid, "study: --csv is of --design two-groups; the others have --json");
  if (options.source.masked) throw Error(ErrorKind::invalid, "study: --masked is of --design two-groups");
  const analytics::DesignReport report = designReportOf(options.design, options.source);
  writeReport(analytics::designDocument(report), options.html, options.pdf, options.force);
  if (isExported(options)) noteExports(options, report.attempts);
  if (options.json) {
    printResult("design", nlohmann::ordered_json::parse(analytics::designJson(report)));
  } else {
    analytics::printDesign(report, std::cout);
  }
  return static_cast<int>(ExitCode::yes);
}

}  // namespace

void addStudy(CLI::App& app, Run& run) {
  const auto options = std::make_shared<ParsedStudyOptions>();
  CLI::App* command = app.add_subcommand(
      "study", "Compare groups of a cohort, or of a table from elsewhere, in two groups or another design");
  addStudySource(*command, options->source);
  command->add_flag("--masked", options->source.masked,
                    "Call the protocol's groups \"group 1\" and \"group 2\" until its analysis is locked");
  addDesignOptions(*command, options->design);
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
      if (!options->source.database.empty()) analytics::refuseUnsound(options->source.database);
      return designOf(options->design, options->source) == analytics::Design::twoGroups ? runTwoGroups(*options)
                                                                                        : runDesign(*options);
    };
  });
}

}  // namespace calot::apps
