// SPDX-License-Identifier: GPL-3.0-or-later
// Three or more independent groups, and two groups compared within strata, such as sites.
#include <fmt/format.h>

#include "analytics/design/design_report.h"
#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/rank_tests.h"
#include "analytics/statistics/two_groups.h"

namespace calot::analytics {
namespace {

struct SeveralGroupsRow {
  const DesignFigure* figure = nullptr;
  std::vector<std::vector<double>> values;
  KruskalWallis test;
  std::vector<DunnPair> pairs;
};

std::string quartilesText(const std::vector<double>& values) {
  return fmt::format("{} {}", significant(*median(values)),
                     intervalText(*quantile(values, 0.25), *quantile(values, 0.75)));
}

DesignJson severalJson(const DesignData& data, const SeveralGroupsRow& row, const std::optional<double>& adjusted) {
  DesignJson groups = DesignJson::array(), pairs = DesignJson::array();
  for (std::size_t g = 0; g < row.values.size(); ++g) {
    groups.push_back({{"group", data.groups[g]},
                      {"n", row.values[g].size()},
                      {"median", *median(row.values[g])},
                      {"lower_quartile", *quantile(row.values[g], 0.25)},
                      {"upper_quartile", *quantile(row.values[g], 0.75)}});
  }
  for (const DunnPair& pair : row.pairs) {
    pairs.push_back({{"first", data.groups[pair.first]},
                     {"second", data.groups[pair.second]},
                     {"z", pair.z},
                     {"p", pair.p},
                     {"p_holm", pair.adjusted}});
  }
  return {{"figure", row.figure->name},
          {"unit", row.figure->unit},
          {"groups", groups},
          {"kruskal_wallis",
           {{"h", row.test.h},
            {"df", row.test.df},
            {"p", row.test.p},
            {"p_holm", optionalJson(adjusted)},
            {"epsilon_squared", row.test.epsilonSquared}}},
          {"dunn", pairs}};
}

}  // namespace

void analyseSeveralGroups(const DesignData& data, const DesignChoices&, DesignReport& report) {
  std::vector<SeveralGroupsRow> rows;
  std::vector<std::pair<std::string, std::string>> refused;
  std::vector<std::optional<double>> p;
  bool small = false;
  for (const DesignFigure& figure : data.figures) {
    SeveralGroupsRow row{&figure, byGroup(data, oneEachOf(figure)), {}, {}};
    const Expected<KruskalWallis> test = kruskalWallis(row.values);
    if (!test) {
      refused.emplace_back(figure.name, test.reason());
      continue;
    }
    row.test = *test;
    row.pairs = *dunn(row.values);
    for (const auto& group : row.values) small = small || group.size() < 5;
    p.emplace_back(test->p);
    rows.push_back(std::move(row));
  }
  askForResults(data, rows.size(), refused);
  const std::vector<std::optional<double>> adjusted = holmOver(p);
  std::vector<std::string> columns{"=figure"};
  for (const std::string& group : data.groups) columns.push_back(group + ": n");
  for (const char* title : {"H", "p", "Holm", "epsilon2"}) columns.emplace_back(title);
  ReportTable tests = tableOf("Kruskal-Wallis", columns);
  ReportTable medians = tableOf("Medians and quartiles", {"=figure"});
  for (const std::string& group : data.groups) medians.columns.emplace_back(group, TextTable::Align::right);
  ReportTable pairs = tableOf("Pairs (Dunn)", {"=figure", "=pair", "z", "p", "Holm"});
  report.json["results"] = DesignJson::array();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const SeveralGroupsRow& row = rows[i];
    std::vector<std::string> cells{figureTitle(*row.figure)}, middle{figureTitle(*row.figure)};
    for (const auto& group : row.values) {
      cells.push_back(fmt::format("{}", group.size()));
      middle.push_back(quartilesText(group));
    }
    for (const std::string& cell : {significant(row.test.h), pText(row.test.p), pOrDash(adjusted[i]),
                                    fmt::format("{:.3f}", row.test.epsilonSquared)})
      cells.push_back(cell);
    tests.rows.push_back(cells);
    medians.rows.push_back(middle);
    for (const DunnPair& pair : row.pairs) {
      pairs.rows.push_back({pair.first == 0 && pair.second == 1 ? figureTitle(*row.figure) : "",
                            fmt::format("{} - {}", data.groups[pair.first], data.groups[pair.second]),
                            fmt::format("{:+.2f}", pair.z), pText(pair.p), pText(pair.adjusted)});
    }
    report.json["results"].push_back(severalJson(data, row, adjusted[i]));
  }
  report.tables = {std::move(tests), std::move(medians), std::move(pairs)};
  report.notes.push_back(fmt::format(
      "Holm beside H: over {} figures; beside a pair: over the pairs of its figure. Epsilon squared: share of the "
      "ranks' "
      "variance between the groups, 0 to 1. z: positive where the pair's first group has the higher values.",
      rows.size()));
  if (small) report.notes.emplace_back("Warning: a group has fewer than five values; p by chi-squared is rough there.");
  noteRefused(report, refused);
  report.methods =
      "Groups were compared by the Kruskal-Wallis test (chi-squared, corrected for ties) with epsilon squared, pairs "
      "by "
      "Dunn's test on the ranks of all groups, adjusted by Holm's method. Quartiles are of type 7.";
}

void analyseStrata(const DesignData& data, const DesignChoices& choices, DesignReport& report) {
  std::vector<std::pair<std::string, std::string>> refused;
  std::vector<std::pair<const DesignFigure*, StratifiedRankSum>> rows;
  std::vector<std::size_t> people;
  std::vector<std::optional<double>> p;
  for (const DesignFigure& figure : data.figures) {
    const OneEach each = oneEachOf(figure);
    std::vector<Stratum> strata(data.strata.size());
    for (std::size_t i = 0; i < each.person.size(); ++i) {
      const DesignPerson& person = data.people[each.person[i]];
      (person.group == 0 ? strata[person.stratum].x : strata[person.stratum].y).push_back(each.value[i]);
    }
    const Expected<StratifiedRankSum> test = stratifiedRankSum(strata);
    if (!test) {
      refused.emplace_back(figure.name, test.reason());
      continue;
    }
    rows.emplace_back(&figure, *test);
    people.push_back(each.person.size());
    p.emplace_back(test->p);
  }
  askForResults(data, rows.size(), refused);
  const std::vector<std::optional<double>> adjusted = holmOver(p);
  ReportTable table = tableOf(fmt::format("Within {} strata", data.strata.size()),
                              {"=figure", "n", "strata", "left out", "A", "z", "p", "Holm"});
  report.json["strata"] = data.strata;
  report.json["results"] = DesignJson::array();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& [figure, test] = rows[i];
    table.rows.push_back({figureTitle(*figure), fmt::format("{}", people[i]), fmt::format("{}", test.strata),
                          fmt::format("{}", test.left), fmt::format("{:.3f}", test.a), fmt::format("{:+.2f}", test.z),
                          pText(test.p), pOrDash(adjusted[i])});
    report.json["results"].push_back({{"figure", figure->name},
                                      {"unit", figure->unit},
                                      {"n", people[i]},
                                      {"strata", test.strata},
                                      {"strata_left_out", test.left},
                                      {"a", test.a},
                                      {"z", test.z},
                                      {"p", test.p},
                                      {"p_holm", optionalJson(adjusted[i])}});
  }
  report.tables.push_back(std::move(table));
  report.notes.push_back(
      fmt::format("A: chance that a value of {} is larger than one of {} of the same stratum, ties counting one half. "
                  "Left out: strata with one group, or with all values equal. Holm: over {} figures.",
                  data.groups[0], data.groups[1], rows.size()));
  noteRefused(report, refused);
  report.methods = fmt::format(
      "Groups were compared within the strata of \"{}\" by van Elteren's stratified rank sum test (normal "
      "approximation, corrected for ties); p values were adjusted by Holm's method.",
      choices.strata);
}

}  // namespace calot::analytics
