// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/study_options.h"

#include <optional>

#include "apps/calot/cohort_option.h"
#include "apps/calot/environment.h"
#include "apps/calot/wrong_word.h"
#include "recorder/base/errors.h"

namespace calot::apps {
namespace {

void addCohortOptions(CLI::App& command, StudySource& options, CLI::Option& table) {
  std::vector<CLI::Option*> added;
  added.push_back(addCohortOption(command, options.database));
  CLI::Option* protocol = command.add_option(
      "--protocol", options.protocol,
      "The study's protocol, a file or the name of one that comes with the program; it makes the choices");
  added.push_back(command.add_option("--cohort-name", options.cohortName,
                                     "Only attempts of the participants of this cohort (calot cohort name)"));
  added.push_back(command
                      .add_option("--group-by", options.groupBy,
                                  "What makes the groups: the participants' group or the performers' profile")
                      ->check(oneOf({"performer", "group"}))
                      ->capture_default_str());
  added.push_back(command.add_flag("--include-synthetic", options.cohort.includeSynthetic,
                                   "Take in what performers made (watermarked)"));
  added.push_back(
      command.add_flag("--include-practice", options.cohort.includePractice, "Take in attempts in practice mode"));
  added.push_back(
      command.add_flag("--include-branches", options.cohort.includeBranches, "Take in branches of other attempts"));
  command
      .add_flag("--phases", options.cohort.includePhases,
                "The checkpoints of each phase of the procedure, too (else the phases' durations, and what --family or "
                "the protocol names)")
      ->excludes(&table);
  added.push_back(command.add_option("--key", options.cohort.key, "Only attempts of this comparability key"));
  added.push_back(command.add_flag("--mix-keys", options.cohort.mixKeys,
                                   "Compare across scenes, devices and versions, and say so"));
  for (CLI::Option* option : added) option->excludes(&table);
  for (CLI::Option* option : {added[2], added[3], added[4], added[5]}) option->excludes(protocol);
}

void addTableOptions(CLI::App& command, StudySource& options, CLI::Option& table) {
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

analytics::Study plainStudyOf(StudySource& options, const analytics::StudyProgress& progress) {
  if (!options.attemptRule.empty()) {
    options.choices.attemptRule =
        options.attemptRule == "first" ? analytics::AttemptRule::first : analytics::AttemptRule::mean;
  }
  if (!options.table.empty()) {
    static_cast<analytics::StudyChoices&>(options.elsewhere) = options.choices;
    if (!options.protocol.empty())
      options.elsewhere.protocol = analytics::readProtocol(findAsset(options.protocol, "protocols", "protocol"));
    return analytics::makeTableStudy(readCsvTable(options.table), options.elsewhere);
  }
  if (options.database.empty()) throw Error(ErrorKind::invalid, "name a cohort database, or a table with --table");
  static_cast<analytics::StudyChoices&>(options.cohort) = options.choices;
  options.cohort.grouping =
      options.groupBy == "performer" ? analytics::Grouping::performer : analytics::Grouping::group;
  if (!options.cohortName.empty()) options.cohort.cohort = analytics::CohortInUse{options.cohortName, {}};
  const auto read = analytics::CohortDatabase::Access::read;
  const analytics::AssessmentDatabase assessment(options.database, read);
  if (!options.protocol.empty()) options.cohort = protocolStudyOptions(options, assessment);
  const analytics::CohortDatabase cohort(options.database, read);
  if (options.cohort.protocol)
    return analytics::makeProtocolStudy(cohort, assessment, options.cohort, options.masked, progress);
  if (options.masked) throw Error(ErrorKind::invalid, "study: --masked needs the --protocol whose groups are masked");
  analytics::Study study = analytics::makeStudy(cohort, options.cohort, progress);
  analytics::addRatings(study, assessment);
  return study;
}

}  // namespace

analytics::StudyOptions protocolStudyOptions(const StudySource& source, const analytics::AssessmentDatabase& database) {
  analytics::StudyOptions options = source.cohort;
  if (!source.cohortName.empty()) options.cohort = analytics::CohortInUse{source.cohortName, {}};
  analytics::ProtocolInUse& use = options.protocol.emplace();
  use.protocol = analytics::readProtocol(findAsset(source.protocol, "protocols", "protocol"));
  use.registered = database.protocols(use.protocol.name);
  return options;
}

analytics::Study studyOf(StudySource& options, const analytics::StudyProgress& progress) {
  analytics::Study study = plainStudyOf(options, progress);
  if (study.better.empty() && !(study.protocol && study.protocol->masked))
    study.remarks.emplace_back("--better GROUP says which group is expected to do better.");
  for (std::string& remark : study.remarks) {
    if (study.phasesLeftOut && remark.ends_with("single phases are left out.")) remark += " --phases takes them in.";
  }
  return study;
}

void addStudySource(CLI::App& command, StudySource& source) {
  CLI::Option* table = command.add_option("--table", source.table, "A CSV file instead of a cohort");
  addCohortOptions(command, source, *table);
  addTableOptions(command, source, *table);
  command.add_option("--groups", source.choices.groups, "The two groups to compare, A,B")
      ->delimiter(',')
      ->allow_extra_args(false);
  command.add_option("--better", source.choices.better, "The group that is expected to do better (the hypothesis)");
  command
      .add_option("--attempt-rule", source.attemptRule,
                  "One value of a participant's several attempts: the first, or the mean")
      ->check(oneOf({"first", "mean"}));
  command
      .add_option("--family", source.choices.family, "Rows whose p values are adjusted for each other (default: all)")
      ->delimiter(',')
      ->allow_extra_args(false);
  for (const char* name : {"--groups", "--better", "--attempt-rule", "--family"})
    command.get_option(name)->excludes(command.get_option("--protocol"));
}

}  // namespace calot::apps
