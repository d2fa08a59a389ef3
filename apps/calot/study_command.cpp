// SPDX-License-Identifier: GPL-3.0-or-later
// calot study: groups side by side and the other designs, of a cohort or of a table from elsewhere.

#include "apps/calot/study_command.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/withdraw.h"
#include "analytics/design/design_report.h"
#include "analytics/report/study_output.h"
#include "apps/calot/command.h"
#include "apps/calot/environment.h"
#include "gui/report/pdf_report.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/loop.h"

namespace calot::apps {
namespace {

/// @param table that excludes them, or null
void addCohortOptions(CLI::App& command, StudySource& options, CLI::Option* table) {
  CLI::Option* cohort = addCohortOption(command, options.database);
  command.add_option("--protocol", options.protocol,
                     "The study's protocol, a file or the name of one that comes with the program; it makes the "
                     "choices");
  command.add_option("--cohort-name", options.cohortName,
                     "Only attempts of the participants of this cohort (calot cohort name)");
  addChoice(command, "--group-by", options.groupBy,
            "Property that makes the groups: the participants' group or the performers' profile",
            {"performer", "group"});
  command.add_flag("--include-synthetic", options.cohort.includeSynthetic,
                   "Take in what performers made (watermarked)");
  command.add_flag("--include-practice", options.cohort.includePractice, "Take in attempts in practice mode");
  command.add_flag("--include-branches", options.cohort.includeBranches, "Take in branches of other attempts");
  command.add_flag("--phases", options.cohort.includePhases,
                   "The checkpoints of each phase of the procedure, too (else the phases' durations, and what --family "
                   "or the protocol names)");
  command.add_option("--key", options.cohort.key, "Only attempts of this comparability key");
  command.add_flag("--mix-keys", options.cohort.mixKeys,
                   "Compare across scenes, devices, trackers and versions, and say so");
  if (table != nullptr) cohort->excludes(table);
  for (const char* name : {"--cohort-name", "--group-by", "--include-synthetic", "--include-practice",
                           "--include-branches", "--phases", "--key", "--mix-keys"})
    if (table != nullptr) command.get_option(name)->excludes(table);
  for (const char* name : {"--group-by", "--include-synthetic", "--include-practice", "--include-branches"})
    command.get_option(name)->excludes(command.get_option("--protocol"));
}

void addTableOptions(CLI::App& command, StudySource& options, CLI::Option& table) {
  analytics::TableStudyOptions& study = options.elsewhere;
  command.add_option("--participant-column", study.participantColumn, "Column of who it was")->needs(&table);
  command.add_option("--group-column", study.groupColumn, "Column of the study group")->needs(&table);
  command.add_option("--outcome", study.outcomes, "Column to compare; NAME:lower or NAME:higher says what is better")
      ->allow_extra_args(false)
      ->needs(&table);
  addList(command, "--occasion-column", study.occasionColumns, "Column of the occasion; several: A,B")->needs(&table);
  command.add_option("--occasion", study.occasion, "The occasion to compare; of several columns: a/b")->needs(&table);
  command.add_option("--baseline-occasion", study.baselineOccasion, "The occasion whose value is the baseline")
      ->needs(&table);
  addSimilarNames(command, options.similarNames)->needs(&table);
}

/// The words of the command line as the library has them.
void settle(StudySource& source) {
  if (!source.attemptRule.empty())
    source.choices.attemptRule =
        source.attemptRule == "first" ? analytics::AttemptRule::first : analytics::AttemptRule::mean;
  source.cohort.grouping = source.groupBy == "performer" ? analytics::Grouping::performer : analytics::Grouping::group;
  if (!source.cohortName.empty()) source.cohort.cohort = analytics::CohortInUse{source.cohortName, {}};
}

/// @param strata column of the strata, or empty
CsvTable tableOf(const StudySource& source, const std::string& strata) {
  CsvTable table = readCsvTable(source.table);
  std::vector<recorder::NameColumn> names{
      {source.elsewhere.participantColumn}, {source.elsewhere.groupColumn}, {strata}};
  for (const std::string& column : source.elsewhere.occasionColumns) names.push_back({column});
  recorder::spellNames(table, names, source.similarNames);
  return table;
}

analytics::Study plainStudyOf(StudySource& options, const analytics::StudyProgress& progress) {
  if (!options.table.empty()) {
    settle(options);
    static_cast<analytics::StudyChoices&>(options.elsewhere) = options.choices;
    if (!options.protocol.empty())
      options.elsewhere.protocol = analytics::readProtocol(findAsset(options.protocol, "protocols", "protocol"));
    return analytics::makeTableStudy(tableOf(options, {}), options.elsewhere);
  }
  if (options.database.empty()) throw Error(ErrorKind::invalid, "name a cohort database, or a table with --table");
  const analytics::CohortDatabase cohort(options.database, analytics::CohortDatabase::Access::read);
  options.cohort = cohortStudyOptions(options, cohort);
  if (options.cohort.protocol) return analytics::makeProtocolStudy(cohort, options.cohort, options.masked, progress);
  if (options.masked) throw Error(ErrorKind::invalid, "study: --masked needs the --protocol whose groups are masked");
  analytics::Study study = analytics::makeStudy(cohort, options.cohort, progress);
  analytics::addRatings(study, cohort);
  return study;
}

}  // namespace

analytics::StudyOptions protocolStudyOptions(const StudySource& source, const analytics::CohortDatabase& database) {
  analytics::StudyOptions options = source.cohort;
  if (!source.cohortName.empty()) options.cohort = analytics::CohortInUse{source.cohortName, {}};
  analytics::ProtocolInUse& use = options.protocol.emplace();
  use.protocol = analytics::readProtocol(findAsset(source.protocol, "protocols", "protocol"));
  use.registered = database.protocols(use.protocol.name);
  return options;
}

analytics::StudyOptions cohortStudyOptions(StudySource& source, const analytics::CohortDatabase& database) {
  settle(source);
  static_cast<analytics::StudyChoices&>(source.cohort) = source.choices;
  return source.protocol.empty() ? source.cohort : protocolStudyOptions(source, database);
}

analytics::Study studyOf(StudySource& options, const analytics::StudyProgress& progress) {
  analytics::Study study = plainStudyOf(options, progress);
  if (study.better.empty() && !(study.protocol && study.protocol->masked))
    study.remarks.emplace_back("--better GROUP says which group is expected to do better.");
  if (study.source == "cohort" && !study.protocol && options.choices.family.empty())
    study.remarks.emplace_back("Hypotheses are tested: declare them with --family NAME,... or --protocol.");
  for (std::string& remark : study.remarks) {
    if (study.phasesLeftOut && remark.ends_with("single phases are left out.")) remark += " --phases includes them.";
  }
  return study;
}

void addStudySource(CLI::App& command, StudySource& source, bool tables) {
  CLI::Option* table = tables ? command.add_option("--table", source.table, "A CSV file instead of a cohort") : nullptr;
  addCohortOptions(command, source, table);
  if (tables) addTableOptions(command, source, *table);
  addList(command, "--groups", source.choices.groups, "The two groups to compare, A,B");
  command.add_option("--better", source.choices.better, "The group that is expected to do better (the hypothesis)");
  command
      .add_option("--attempt-rule", source.attemptRule,
                  "One value of a participant's several attempts: the first, or the mean")
      ->check(oneOf({"first", "mean"}));
  addList(command, "--family", source.choices.family, "Rows whose p values are adjusted for each other (default: all)");
  for (const char* name : {"--groups", "--better", "--attempt-rule", "--family"})
    command.get_option(name)->excludes(command.get_option("--protocol"));
}

void writeReport(const analytics::ReportDocument& document, const std::string& html, const std::string& pdf, bool force,
                 const analytics::CarriedRecording* recording) {
  const std::string paper = pdf.empty() ? "" : gui::pdfReport(document, recorder::softwareName());
  if (!html.empty()) recorder::writeText(html, analytics::pageHtml(document, recording), force);
  if (!pdf.empty()) recorder::writeText(pdf, paper, force);
}

namespace {

using analytics::Design;

struct DesignOptions {
  std::string design;  ///< empty: implied by other options, else two groups
  analytics::DesignChoices choices;
};

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
  return o.choices.strata.empty() ? Design::twoGroups : Design::strata;
}

void addDesignOptions(CLI::App& command, DesignOptions& o) {
  std::vector<std::string> names;
  for (const analytics::DesignEntry& e : analytics::designs()) names.emplace_back(e.name);
  command.add_option("--design", o.design, "Question to the data; see below (default: two-groups)")
      ->check(oneOf(names));
  command.add_option("--strata", o.choices.strata,
                     "Strata of the designs strata and repeated: of a cohort site or arm, of a table a column");
  command.add_option("--against", o.choices.against,
                     "Figure that others are held against (correlation, agreement): a checkpoint, a column, or of a "
                     "cohort \"rating FORM\"");
  command.add_option("--criterion", o.choices.criterion,
                     "Value that one figure is to reach (learning), in its display unit; adds attempts to "
                     "the criterion");
  addNumber(command, "--in-a-row", o.choices.run, "Attempts in a row that must meet the criterion (learning)", 1, 1000);
  command.add_option("--finished-column", o.choices.finishedColumn,
                     "Column of a table: 1 if the attempt was finished, else 0 (time-to-criterion)");
  command
      .add_option("--error-ratio", o.choices.errorRatio,
                  "Error variance of the second method over that of the first (agreement)")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command.get_option("--groups")->description("The groups to compare, A,B; three or more for --design groups");
  command.footer(helpOfDesigns() + "\n\n" + command.get_footer());
}

/// Chosen or implied: three groups, strata. @throws Error (invalid) for options that the design does not take, or
/// lacks.
Design designOf(const DesignOptions& o, const StudySource& source) {
  const Design design = chosenDesign(o, source);
  const std::string name = analytics::entryOf(design).name;
  const std::vector<DesignOption> own{
      {"--strata", !o.choices.strata.empty(), {Design::strata, Design::repeated}},
      {"--against", !o.choices.against.empty(), {Design::correlation, Design::agreement}},
      {"--criterion", o.choices.criterion.has_value(), {Design::learning}},
      {"--in-a-row", o.choices.run != 1, {Design::learning}},
      {"--finished-column", !o.choices.finishedColumn.empty(), {Design::timeToCriterion}},
      {"--error-ratio", o.choices.errorRatio != 1.0, {Design::agreement}}};
  for (const DesignOption& option : own) {
    if (option.given && std::find(option.designs.begin(), option.designs.end(), design) == option.designs.end())
      failDesign(fmt::format("{} belongs to --design {}, not to {}", option.name,
                             analytics::entryOf(option.designs.front()).name, name));
  }
  if (design == Design::twoGroups) return design;
  if (!source.protocol.empty()) failDesign(fmt::format("a protocol has two groups; it does not fit --design {}", name));
  if (!source.elsewhere.baselineOccasion.empty())
    failDesign(fmt::format("--baseline-occasion belongs to --design two-groups, not to {}", name));
  if (design == Design::strata && o.choices.strata.empty()) failDesign("--design strata needs --strata");
  if (design == Design::correlation && o.choices.against.empty()) failDesign("--design correlation needs --against");
  if (design == Design::timeToCriterion && !source.table.empty() && o.choices.finishedColumn.empty())
    failDesign("--design time-to-criterion of a table needs --finished-column");
  if (!o.choices.criterion && o.choices.run != 1) failDesign("--in-a-row needs --criterion");
  if (o.choices.criterion && !std::isfinite(*o.choices.criterion))
    failDesign("--criterion: a finite number is expected");
  if (source.table.empty() && !o.choices.strata.empty() && o.choices.strata != "site" && o.choices.strata != "arm")
    failDesign("--strata of a cohort: site or arm");
  if (!source.table.empty() && source.elsewhere.occasionColumns.empty() && design == Design::agreement &&
      o.choices.against.empty())
    failDesign("--design agreement of a table needs --against, or --occasion-column of the device");
  return design;
}

/// @throws Error as analytics::cohortDesignData(), tableDesignData() and makeDesignReport().
analytics::DesignReport designReportOf(const DesignOptions& o, StudySource& source) {
  settle(source);
  analytics::DesignChoices choices = o.choices;
  static_cast<analytics::StudyChoices&>(choices) = source.choices;
  choices.design = designOf(o, source);
  if (!source.table.empty())
    return analytics::makeDesignReport(
        analytics::tableDesignData(tableOf(source, choices.strata), source.elsewhere, choices), choices);
  if (source.database.empty()) throw Error(ErrorKind::invalid, "name a cohort database, or a table with --table");
  const analytics::CohortDatabase cohort(source.database, analytics::CohortDatabase::Access::read);
  return analytics::makeDesignReport(analytics::cohortDesignData(cohort, source.cohort, choices), choices);
}

struct StudyCommandOptions {
  StudySource source;
  DesignOptions design;
  std::string csv, html, pdf;
  bool json = false, force = false, all = false;
};

/// Notes in the cohort that attempts went into files: a withdrawal lists them.
void noteExports(const StudyCommandOptions& options, const std::vector<std::string>& attempts) {
  const std::vector<std::pair<std::string, std::string>> written{
      {"study-csv", options.csv}, {"study-html", options.html}, {"study-pdf", options.pdf}};
  try {
    for (const auto& [kind, file] : written) {
      if (!file.empty()) analytics::recordExport(options.source.database, kind, file, attempts);
    }
  } catch (const Error& e) {
    Progress::erase();
    std::cerr << "calot: warning: the export could not be registered for later withdrawal: " << messageOf(e) << '\n';
  }
}

bool isExported(const StudyCommandOptions& options) {
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

analytics::StudyDetail detailOf(const StudyCommandOptions& options) {
  return options.all ? analytics::StudyDetail::all : analytics::StudyDetail::first;
}

void printStudy(const analytics::Study& study, analytics::StudyDetail detail) {
  analytics::printStudy(study, std::cout, detail);
  if (detail == analytics::StudyDetail::all) return;
  const auto others = std::count_if(study.rows.begin(), study.rows.end(), [](const analytics::StudyRow& row) {
    return !row.leading && !analytics::hasNoValue(row);
  });
  printText(
      fmt::format("{} more figures and the methods: --all. A report, with or without them: --pdf, --html.\n", others));
}

void runTwoGroups(StudyCommandOptions& options, Progress& progress) {
  const analytics::Study study = studyOf(options.source, [&](double share, const char*) { progress.showShare(share); });
  if (!options.csv.empty()) analytics::writeStudyCsv(study, options.csv, options.force);
  writeReport(analytics::studyDocument(study, detailOf(options)), options.html, options.pdf, options.force);
  if (isExported(options)) noteExports(options, attemptsIn(study, options.source.database));
  Progress::erase();
  options.json ? printResult("study", analytics::studyTree(study)) : printStudy(study, detailOf(options));
}

void runDesign(StudyCommandOptions& options) {
  if (!options.csv.empty())
    throw Error(ErrorKind::invalid, "study: --csv belongs to --design two-groups; the others have --json");
  if (options.source.masked) throw Error(ErrorKind::invalid, "study: --masked belongs to --design two-groups");
  if (options.source.choices.unequalSpread)
    throw Error(ErrorKind::invalid, "study: --unequal-spread belongs to --design two-groups");
  const analytics::DesignReport report = designReportOf(options.design, options.source);
  writeReport(analytics::designDocument(report), options.html, options.pdf, options.force);
  if (isExported(options)) noteExports(options, report.attempts);
  printResult(options.json, "design", report.json, [&](std::ostream& out) { analytics::printDesign(report, out); });
}

void study(StudyCommandOptions& o) {
  Progress progress("Computing the study", o.json);
  for (const std::string& file : {o.html, o.pdf}) {
    if (!file.empty()) recorder::refuseOutput(file, o.force);
  }
  if (!o.source.database.empty()) analytics::refuseUnsound(o.source.database);
  return designOf(o.design, o.source) == Design::twoGroups ? runTwoGroups(o, progress) : runDesign(o);
}

}  // namespace

void addStudy(CLI::App& app, Run& run) {
  const auto [command, options] =
      addCommand(app, run,
                 {"study", "Compare groups of a cohort, or of a table from elsewhere, in two groups or another design",
                  "calot study c.db --attempt-rule mean",
                  "calot study --table f.csv --participant-column person --group-column level --outcome seconds:lower"},
                 study);
  addStudySource(*command, options->source);
  command->add_flag("--masked", options->source.masked,
                    "Call the protocol's groups \"group 1\" and \"group 2\" until its analysis is locked");
  command
      ->add_flag("--unequal-spread", options->source.choices.unequalSpread,
                 "Test by Brunner and Munzel in place of Mann and Whitney, for groups that may scatter differently")
      ->excludes("--protocol");
  addDesignOptions(*command, options->design);
  command->add_flag("--json", options->json, "Print JSON");
  command->add_flag("--all", options->all, "Every figure, in reports too, not only the first result");
  command->add_option("--csv", options->csv,
                      "Write study.csv, values.csv, attempts.csv, flow.csv and coverage.csv into this folder");
  command->add_option("--html", options->html, "Write one self-contained page with figures");
  command->add_option("--pdf", options->pdf, "Write the same on A4 pages");
  command->add_flag("--force", options->force, "Replace files that are there");
}

}  // namespace calot::apps
