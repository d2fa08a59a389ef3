// SPDX-License-Identifier: GPL-3.0-or-later
// Two groups compared within strata, such as sites.
#include <fmt/format.h>

#include "analytics/design/design_parts.h"
#include "analytics/statistics/two_groups.h"

namespace calot::analytics {

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
