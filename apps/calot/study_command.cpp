// SPDX-License-Identifier: GPL-3.0-or-later
// calot study: groups side by side and the other designs, of a cohort or of a table from elsewhere.
#include <fmt/format.h>
#include <algorithm>
#include <CLI/CLI.hpp>
#include <cmath>
#include <iostream>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "analytics/cohort/check.h"
#include "analytics/cohort/withdraw.h"
#include "analytics/design/design_report.h"
#include "analytics/report/study_output.h"
#include "apps/calot/commands.h"
#include "apps/calot/environment.h"
#include "apps/calot/report_files.h"
#include "apps/calot/results.h"
#include "apps/calot/study_options.h"
#include "apps/calot/wrong_word.h"
#include "apps/common/advice.h"
#include "apps/common/exit_code.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_output.h"

namespace calot::apps {
namespace {

struct DesignOptions {
  std::string design;  ///< empty: implied by other options, else two groups
  std::string strata, against, finishedColumn;
  std::optional<double> criterion;
  std::size_t run = 1;
  double errorRatio = 1.0;
};

/// Adds --design and what single designs need. @pre addStudySource() was called
void addDesignOptions(CLI::App& command, DesignOptions& options);

/// Chosen or implied: three groups, strata. @throws Error (invalid) for options that the design does not take, or
/// lacks.
analytics::Design designOf(const DesignOptions& options, const StudySource& source);

/// @throws Error as analytics::cohortDesignData(), tableDesignData() and makeDesignReport().
analytics::DesignReport designReportOf(const DesignOptions& options, StudySource& source);

using analytics::Design;

/// An option that belongs to some designs alone.
struct DesignOption {
  const char* name;
  bool given;
  std::vector<Design> designs;
};

[[noreturn]] void failDesign(const std::string& what) { throw Error(ErrorKind::invalid, "study: " + what); }

std::string helpOfDesigns() {
  std::string text = "Designs (--design):\n";
  for (const analytics::DesignEntry& e : analytics::designs())
    text += fmt::format("  {:<18}{}? {}\n", e.name, e.question, e.method);
  return text +
         "Implied: groups by three names in --groups, strata by --strata. The options above choose whose attempts\n"
         "and which figures (--family, of a table --outcome); --attempt-rule makes one value of several where a "
         "design\n"
         "takes one from each participant.";
}

Design chosenDesign(const DesignOptions& o, const StudySource& source) {
  if (!o.design.empty()) return *analytics::designOf(o.design);
  if (source.choices.groups.size() > 2) return Design::severalGroups;
  return o.strata.empty() ? Design::twoGroups : Design::strata;
}

void addDesignOptions(CLI::App& command, DesignOptions& o) {
  std::vector<std::string> names;
  for (const analytics::DesignEntry& e : analytics::designs()) names.emplace_back(e.name);
  command.add_option("--design", o.design, "What is asked of the data; see below (default: two-groups)")
      ->check(oneOf(names));
  command.add_option("--strata", o.strata,
                     "Strata of the designs strata and repeated: of a cohort site or arm, of a table a column");
  command.add_option("--against", o.against,
                     "Figure that others are held against (correlation, agreement): a checkpoint, a column, or of a "
                     "cohort \"rating FORM\"");
  command.add_option("--criterion", o.criterion,
                     "Value that one figure is to reach (learning), in its display unit; adds attempts to "
                     "the criterion");
  command.add_option("--in-a-row", o.run, "Attempts in a row that must meet the criterion (learning)")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command.add_option("--finished-column", o.finishedColumn,
                     "Of a table: whether the attempt was finished, 1 or 0 (time-to-criterion)");
  command
      .add_option("--error-ratio", o.errorRatio,
                  "Error variance of the second method over that of the first (agreement)")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command.get_option("--groups")->description("The groups to compare, A,B; three or more for --design groups");
  command.footer(helpOfDesigns());
}

analytics::Design designOf(const DesignOptions& o, const StudySource& source) {
  const Design design = chosenDesign(o, source);
  const std::string name = analytics::entryOf(design).name;
  const std::vector<DesignOption> own{{"--strata", !o.strata.empty(), {Design::strata, Design::repeated}},
                                      {"--against", !o.against.empty(), {Design::correlation, Design::agreement}},
                                      {"--criterion", o.criterion.has_value(), {Design::learning}},
                                      {"--in-a-row", o.run != 1, {Design::learning}},
                                      {"--finished-column", !o.finishedColumn.empty(), {Design::timeToCriterion}},
                                      {"--error-ratio", o.errorRatio != 1.0, {Design::agreement}}};
  for (const DesignOption& option : own) {
    if (option.given && std::find(option.designs.begin(), option.designs.end(), design) == option.designs.end())
      failDesign(fmt::format("{} is of --design {}, not of {}", option.name,
                             analytics::entryOf(option.designs.front()).name, name));
  }
  if (design == Design::twoGroups) return design;
  if (!source.protocol.empty()) failDesign(fmt::format("a protocol is of two groups, not of --design {}", name));
  if (!source.elsewhere.baselineOccasion.empty())
    failDesign(fmt::format("--baseline-occasion is of --design two-groups, not of {}", name));
  if (design == Design::strata && o.strata.empty()) failDesign("--design strata needs --strata");
  if (design == Design::correlation && o.against.empty()) failDesign("--design correlation needs --against");
  if (design == Design::timeToCriterion && !source.table.empty() && o.finishedColumn.empty())
    failDesign("--design time-to-criterion of a table needs --finished-column");
  if (!o.criterion && o.run != 1) failDesign("--in-a-row needs --criterion");
  if (o.criterion && !std::isfinite(*o.criterion)) failDesign("--criterion: a finite number is wanted");
  if (source.table.empty() && !o.strata.empty() && o.strata != "site" && o.strata != "arm")
    failDesign("--strata of a cohort: site or arm");
  if (!source.table.empty() && source.elsewhere.occasionColumns.empty() && design == Design::agreement &&
      o.against.empty())
    failDesign("--design agreement of a table needs --against, or --occasion-column of the device");
  return design;
}

analytics::DesignReport designReportOf(const DesignOptions& o, StudySource& source) {
  analytics::DesignChoices choices;
  static_cast<analytics::StudyChoices&>(choices) = source.choices;
  choices.design = designOf(o, source);
  if (!source.attemptRule.empty())
    choices.attemptRule = source.attemptRule == "first" ? analytics::AttemptRule::first : analytics::AttemptRule::mean;
  choices.strata = o.strata;
  choices.against = o.against;
  choices.finishedColumn = o.finishedColumn;
  choices.criterion = o.criterion;
  choices.run = o.run;
  choices.errorRatio = o.errorRatio;
  if (!source.table.empty())
    return analytics::makeDesignReport(
        analytics::tableDesignData(readCsvTable(source.table), source.elsewhere, choices), choices);
  if (source.database.empty()) throw Error(ErrorKind::invalid, "name a cohort database, or a table with --table");
  source.cohort.grouping = source.groupBy == "performer" ? analytics::Grouping::performer : analytics::Grouping::group;
  if (!source.cohortName.empty()) source.cohort.cohort = analytics::CohortInUse{source.cohortName, {}};
  const auto read = analytics::CohortDatabase::Access::read;
  const analytics::DesignData data =
      analytics::cohortDesignData(analytics::CohortDatabase(source.database, read),
                                  analytics::AssessmentDatabase(source.database, read), source.cohort, choices);
  return analytics::makeDesignReport(data, choices);
}

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
    printResult("study", analytics::studyTree(study));
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
    printResult("design", report.json);
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
