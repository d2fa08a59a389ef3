// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/design_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/calot/wrong_word.h"
#include "recorder/base/errors.h"

namespace calot::apps {
namespace {

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

}  // namespace

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
                     "Value that one figure is to reach (learning), in its display unit; adds attempts to the "
                     "criterion and CUSUM");
  command.add_option("--in-a-row", o.run, "Attempts in a row that must meet the criterion (learning)")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command.add_option("--failure-rates", o.failureRates, "Acceptable and unacceptable rate of the CUSUM (learning)")
      ->delimiter(',')
      ->expected(2)
      ->default_str("0.05,0.15");
  command.add_option("--curve", o.shape, "Shape of the learning curve: a - b/x, a - b x^-c or a - b exp(-c x)")
      ->check(oneOf({"inverse", "power", "exponential"}))
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
                                      {"--failure-rates", !o.failureRates.empty(), {Design::learning}},
                                      {"--curve", o.shape != "inverse", {Design::learning}},
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
  if (!o.criterion && (o.run != 1 || !o.failureRates.empty()))
    failDesign("--in-a-row and --failure-rates need --criterion");
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
  choices.shape = o.shape == "power"         ? analytics::CurveShape::power
                  : o.shape == "exponential" ? analytics::CurveShape::exponential
                                             : analytics::CurveShape::inverse;
  if (!o.failureRates.empty()) {
    choices.goal.acceptable = o.failureRates[0];
    choices.goal.unacceptable = o.failureRates[1];
  }
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

}  // namespace calot::apps
