// SPDX-License-Identifier: GPL-3.0-or-later
// calot study: two groups side by side, of a cohort or of a table from elsewhere.
#include <iostream>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "analytics/cohort/withdraw.h"
#include "analytics/report/study_output.h"
#include "analytics/report/table_study.h"
#include "apps/calot/commands.h"
#include "recorder/errors.h"
#include "recorder/formats/text_output.h"

namespace calot::apps {
namespace {

struct Options {
  std::string database, groupBy = "group", table, csv, html, attemptRule;
  bool json = false, force = false;
  analytics::StudyChoices choices;
  analytics::StudyOptions cohort;
  analytics::TableStudyOptions elsewhere;
};

void addCohortOptions(CLI::App& command, Options& options, CLI::Option& table) {
  std::vector<CLI::Option*> added;
  added.push_back(command.add_option("cohort", options.database, "Cohort database"));
  added.push_back(command
                      .add_option("--group-by", options.groupBy,
                                  "What makes the groups: the participants' group or the performers' profile")
                      ->check(CLI::IsMember({"performer", "group"}))
                      ->capture_default_str());
  added.push_back(command.add_flag("--include-synthetic", options.cohort.includeSynthetic,
                                   "Take in what performers made (watermarked)"));
  added.push_back(
      command.add_flag("--include-practice", options.cohort.includePractice, "Take in attempts in practice mode"));
  added.push_back(
      command.add_flag("--include-branches", options.cohort.includeBranches, "Take in branches of other attempts"));
  added.push_back(command.add_flag("--mix-keys", options.cohort.mixKeys,
                                   "Compare across scenes, devices and versions, and say so"));
  for (CLI::Option* option : added) option->excludes(&table);
}

void addTableOptions(CLI::App& command, Options& options, CLI::Option& table) {
  analytics::TableStudyOptions& study = options.elsewhere;
  command.add_option("--participant-column", study.participantColumn, "Column of who it was")->needs(&table);
  command.add_option("--group-column", study.groupColumn, "Column of the study group")->needs(&table);
  command.add_option("--outcome", study.outcomes, "Column to compare; NAME:lower or NAME:higher says what is better")
      ->allow_extra_args(false)
      ->needs(&table);
  command.add_option("--occasion-column", study.occasionColumns, "Column of the occasion; several: A,B")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->needs(&table);
  command.add_option("--occasion", study.occasion, "The occasion to compare; of several columns: a/b")->needs(&table);
  command.add_option("--baseline-occasion", study.baselineOccasion, "The occasion whose value is the baseline")
      ->needs(&table);
}

analytics::Study studyOf(Options& options) {
  if (!options.attemptRule.empty()) {
    options.choices.attemptRule =
        options.attemptRule == "first" ? analytics::AttemptRule::first : analytics::AttemptRule::mean;
  }
  if (!options.table.empty()) {
    static_cast<analytics::StudyChoices&>(options.elsewhere) = options.choices;
    return analytics::makeTableStudy(analytics::readCsvTable(options.table), options.elsewhere);
  }
  if (options.database.empty()) throw Error(ExitCode::usage, "study: name a cohort database, or a table with --table");
  static_cast<analytics::StudyChoices&>(options.cohort) = options.choices;
  options.cohort.grouping =
      options.groupBy == "performer" ? analytics::Grouping::performer : analytics::Grouping::group;
  const analytics::CohortDatabase database(options.database, analytics::CohortDatabase::Access::read);
  return analytics::makeStudy(database, options.cohort);
}

/// Notes in the cohort whose attempts went into files: a withdrawal lists them.
void noteExports(const Options& options, const analytics::Study& study) {
  if (options.database.empty() || (options.csv.empty() && options.html.empty())) return;
  std::set<std::string> units;
  for (const analytics::StudyRow& row : study.rows) {
    for (const auto& group : row.participants) units.insert(group.begin(), group.end());
  }
  std::vector<std::string> attempts;
  const analytics::CohortDatabase database(options.database, analytics::CohortDatabase::Access::read);
  for (const analytics::AttemptRow& a : database.listAttempts()) {
    if (units.count(a.participant.empty() ? "attempt " + a.uuid : a.participant) > 0) attempts.push_back(a.uuid);
  }
  try {
    if (!options.csv.empty()) analytics::recordExport(options.database, "study-csv", options.csv, attempts);
    if (!options.html.empty()) analytics::recordExport(options.database, "study-html", options.html, attempts);
  } catch (const Error& e) {
    std::cerr << "calot: warning: what was written is not noted for withdrawals: " << e.what() << '\n';
  }
}

}  // namespace

void addStudy(CLI::App& app, Run& run) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("study", "Compare two groups of a cohort, or of a table from elsewhere");
  CLI::Option* table = command->add_option("--table", options->table, "A CSV file instead of a cohort");
  addCohortOptions(*command, *options, *table);
  addTableOptions(*command, *options, *table);
  command->add_option("--groups", options->choices.groups, "The two groups to compare, A,B")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--better", options->choices.better, "The group that is expected to do better (the hypothesis)");
  command
      ->add_option("--attempt-rule", options->attemptRule,
                   "One value of a participant's several attempts: the first, or the mean")
      ->check(CLI::IsMember({"first", "mean"}));
  command
      ->add_option("--family", options->choices.family,
                   "Rows whose p values are adjusted for each other (default: all)")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_flag("--json", options->json, "Print JSON");
  command->add_option("--csv", options->csv, "Write study.csv, values.csv and flow.csv into this folder");
  command->add_option("--html", options->html, "Write one self-contained page with figures");
  command->add_flag("--force", options->force, "Replace files that are there");
  command->callback([options, &run] {
    run = [options] {
      if (!options->html.empty()) recorder::refuseOutput(options->html, options->force);
      const analytics::Study study = studyOf(*options);
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
