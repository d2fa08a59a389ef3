// SPDX-License-Identifier: GPL-3.0-or-later
// Three or more independent groups.
#include <fmt/format.h>

#include "analytics/design/design_parts.h"
#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/kruskal_wallis.h"

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

}  // namespace calot::analytics
