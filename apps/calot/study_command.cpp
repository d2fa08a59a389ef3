// SPDX-License-Identifier: GPL-3.0-or-later
// calot study: two groups of a cohort side by side.
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "analytics/report/study.h"
#include "analytics/report/study_output.h"
#include "apps/calot/commands.h"
#include "recorder/errors.h"

namespace calot::apps {

void addStudy(CLI::App& app, Run& run) {
  struct Options {
    std::string database, groupBy = "group", csv;
    bool json = false, force = false;
    analytics::StudyOptions study;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("study", "Compare two groups of a cohort");
  command->add_option("cohort", options->database, "Cohort database")->required();
  command
      ->add_option("--group-by", options->groupBy,
                   "What makes the groups: the participants' group or the performers' profile")
      ->check(CLI::IsMember({"performer", "group"}))
      ->capture_default_str();
  command->add_option("--groups", options->study.groups, "The two groups to compare, A,B")->delimiter(',');
  command->add_flag("--include-synthetic", options->study.includeSynthetic,
                    "Take in what performers made (watermarked)");
  command->add_flag("--include-practice", options->study.includePractice, "Take in attempts in practice mode");
  command->add_flag("--include-branches", options->study.includeBranches, "Take in branches of other attempts");
  command->add_flag("--mix-keys", options->study.mixKeys, "Compare across scenes, devices and versions, and say so");
  command->add_flag("--json", options->json, "Print JSON");
  command->add_option("--csv", options->csv, "Write study.csv, values.csv and flow.csv into this folder");
  command->add_flag("--force", options->force, "Replace CSV files that are there");
  command->callback([options, &run] {
    run = [options] {
      options->study.grouping =
          options->groupBy == "performer" ? analytics::Grouping::performer : analytics::Grouping::group;
      const analytics::CohortDatabase database(options->database, analytics::CohortDatabase::Access::read);
      const analytics::Study study = analytics::makeStudy(database, options->study);
      if (!options->csv.empty()) analytics::writeStudyCsv(study, options->csv, options->force);
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
