// SPDX-License-Identifier: GPL-3.0-or-later
// calot study: two groups side by side, of a cohort or of a table from elsewhere.
#include <iostream>
#include <memory>
#include <set>
#include <string>

#include "analytics/cohort/withdraw.h"
#include "analytics/report/study_output.h"
#include "apps/calot/commands.h"
#include "apps/calot/study_options.h"
#include "recorder/errors.h"
#include "recorder/formats/text_output.h"

namespace calot::apps {
namespace {

struct Options {
  StudySource source;
  std::string csv, html;
  bool json = false, force = false;
};

/// Notes in the cohort whose attempts went into files: a withdrawal lists them.
void noteExports(const Options& options, const analytics::Study& study) {
  if (options.source.database.empty() || (options.csv.empty() && options.html.empty())) return;
  std::set<std::string> units;
  for (const analytics::StudyRow& row : study.rows) {
    for (const auto& group : row.participants) units.insert(group.begin(), group.end());
  }
  std::vector<std::string> attempts;
  const analytics::CohortDatabase database(options.source.database, analytics::CohortDatabase::Access::read);
  for (const analytics::AttemptRow& a : database.listAttempts()) {
    if (units.count(a.participant.empty() ? "attempt " + a.uuid : a.participant) > 0) attempts.push_back(a.uuid);
  }
  try {
    if (!options.csv.empty()) analytics::recordExport(options.source.database, "study-csv", options.csv, attempts);
    if (!options.html.empty()) analytics::recordExport(options.source.database, "study-html", options.html, attempts);
  } catch (const Error& e) {
    std::cerr << "calot: warning: what was written is not noted for withdrawals: " << e.what() << '\n';
  }
}

}  // namespace

void addStudy(CLI::App& app, Run& run) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("study", "Compare two groups of a cohort, or of a table from elsewhere");
  addStudySource(*command, options->source);
  command->add_flag("--json", options->json, "Print JSON");
  command->add_option("--csv", options->csv, "Write study.csv, values.csv and flow.csv into this folder");
  command->add_option("--html", options->html, "Write one self-contained page with figures");
  command->add_flag("--force", options->force, "Replace files that are there");
  command->callback([options, &run] {
    run = [options] {
      if (!options->html.empty()) recorder::refuseOutput(options->html, options->force);
      const analytics::Study study = studyOf(options->source);
      if (!options->csv.empty()) analytics::writeStudyCsv(study, options->csv, options->force);
      if (!options->html.empty()) recorder::writeText(options->html, analytics::studyHtml(study), options->force);
      noteExports(*options, study);
      if (options->json) {
        std::cout << analytics::studyJson(study) << '\n';
      } else {
        analytics::printStudy(study, std::cout);
      }
      return static_cast<int>(ExitCode::yes);
    };
  });
}

}  // namespace calot::apps
