// SPDX-License-Identifier: GPL-3.0-or-later
// Three or more independent groups; two groups compared within strata, such as sites, or over repeated attempts.

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <utility>

#include "analytics/design/design_report.h"
#include "analytics/report/study_population.h"
#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/mixed_models.h"
#include "analytics/statistics/rank_tests.h"
#include "analytics/statistics/two_groups.h"

namespace calot::analytics {
namespace {

/// Median and quartiles of a group.
std::string quartilesText(const ValueTree& group, const ValueTree& row) {
  return fmt::format("{} [{}, {}]", figure4(group["median"], row), figure4(group["lower_quartile"], row),
                     figure4(group["upper_quartile"], row));
}

ValueTree medianTree(const std::string& group, const std::vector<double>& values) {
  return {{"group", group},
          {"n", values.size()},
          {"median", *median(values)},
          {"lower_quartile", *quantile(values, 0.25)},
          {"upper_quartile", *quantile(values, 0.75)}};
}

ValueTree severalTree(const DesignData& data, const std::vector<std::vector<double>>& values,
                      const KruskalWallis& test) {
  ValueTree groups = ValueTree::array(), pairs = ValueTree::array();
  for (std::size_t g = 0; g < values.size(); ++g) groups.push_back(medianTree(data.groups[g], values[g]));
  const std::vector<DunnPair> compared = *dunn(values);
  for (const DunnPair& pair : compared) {
    pairs.push_back({{"first", data.groups[pair.first]},
                     {"second", data.groups[pair.second]},
                     {"z", pair.z},
                     {"p", pair.p},
                     {"p_holm", pair.adjusted}});
  }
  return {
      {"groups", groups},
      {"kruskal_wallis",
       {{"h", test.h}, {"df", test.df}, {"p", test.p}, {"p_holm", nullptr}, {"epsilon_squared", test.epsilonSquared}}},
      {"dunn", pairs}};
}

}  // namespace

void analyseSeveralGroups(const DesignData& data, const DesignChoices&, DesignReport& report) {
  bool small = false;
  ValueTree& results = analyseFigures(data, report, [&](const DesignFigure& figure) {
    const std::vector<std::vector<double>> values = byGroup(data, oneEachOf(figure));
    const Expected<KruskalWallis> test = kruskalWallis(values);
    if (!test) return Expected<ValueTree>(NoResult{test.reason()});
    for (const auto& group : values) small = small || group.size() < 5;
    return Expected<ValueTree>(severalTree(data, values, *test));
  });
  addHolm(results, "/kruskal_wallis");
  std::vector<TreeColumn> tests{{"=figure", "", figureTitle}}, medians = tests;
  for (std::size_t g = 0; g < data.groups.size(); ++g) {
    const std::string group = fmt::format("/groups/{}", g);
    tests.push_back({data.groups[g] + ": n", group + "/n", plain});
    medians.push_back({data.groups[g], group, quartilesText});
  }
  tests.push_back({"H", "/kruskal_wallis/h", digits4});
  tests.push_back({"p", "/kruskal_wallis/p", pValue});
  tests.push_back({"Holm", "/kruskal_wallis/p_holm", pValue});
  tests.push_back({"epsilon2", "/kruskal_wallis/epsilon_squared", share3});
  ReportTable pairs = tableOf("Pairs (Dunn)", {"=figure", "=pair", "z", "p", "Holm"});
  for (const ValueTree& row : results) {
    std::string title = figureTitle(row);
    for (const ValueTree& pair : row["dunn"]) {
      pairs.rows.push_back({std::exchange(title, ""), plain(pair["first"]) + " - " + plain(pair["second"]),
                            signed2(pair["z"]), pValue(pair["p"]), pValue(pair["p_holm"])});
    }
  }
  report.tables = {tableOf("Kruskal-Wallis", results, tests), tableOf("Medians and quartiles", results, medians),
                   std::move(pairs)};
  report.notes.push_back(fmt::format(
      "Holm beside H: over {} figures; beside a pair: over the pairs of its figure. Epsilon squared: share of the "
      "ranks' "
      "variance between the groups, 0 to 1. z: positive where the pair's first group has the higher values.",
      results.size()));
  if (small) report.notes.emplace_back("Warning: a group has fewer than five values; p by chi-squared is rough there.");
  report.methods =
      "Groups were compared by the Kruskal-Wallis test (chi-squared, corrected for ties) with epsilon squared, pairs "
      "by "
      "Dunn's test on the ranks of all groups, adjusted by Holm's method. Quartiles are of type 7.";
}

void analyseStrata(const DesignData& data, const DesignChoices& choices, DesignReport& report) {
  report.json["strata"] = data.strata;
  ValueTree& results = analyseFigures(data, report, [&](const DesignFigure& figure) {
    const OneEach each = oneEachOf(figure);
    std::vector<Stratum> strata(data.strata.size());
    for (std::size_t i = 0; i < each.person.size(); ++i) {
      const DesignPerson& person = data.people[each.person[i]];
      (person.group == 0 ? strata[person.stratum].x : strata[person.stratum].y).push_back(each.value[i]);
    }
    const Expected<StratifiedRankSum> test = stratifiedRankSum(strata);
    if (!test) return Expected<ValueTree>(NoResult{test.reason()});
    const std::optional<Hypothesis> hypothesis = hypothesisOf(figure.direction, data.better, data.groups);
    const bool swapped = hypothesis == Hypothesis::firstSmaller;
    return Expected<ValueTree>(ValueTree{{"n", each.person.size()},
                                         {"strata", test->strata},
                                         {"strata_left_out", test->left},
                                         {"a", swapped ? 1.0 - test->a : test->a},
                                         {"a_of", !hypothesis ? data.groups[0] + " larger" : data.better + " better"},
                                         {"z", test->z},
                                         {"p", test->p}});
  });
  addHolm(results);
  report.tables.push_back(tableOf(fmt::format("Within {} strata", data.strata.size()), results,
                                  {{"=figure", "", figureTitle},
                                   {"n", "/n", plain},
                                   {"strata", "/strata", plain},
                                   {"left out", "/strata_left_out", plain},
                                   {"A", "/a", share3},
                                   {"=of", "/a_of", plain},
                                   {"z", "/z", signed2},
                                   {"p", "/p", pValue},
                                   {"Holm", "/p_holm", pValue}}));
  report.notes.push_back(
      fmt::format("A: chance that one of {} is better than one of the other group in the same stratum, by the figure's "
                  "direction (without one that {} has the larger value), ties counting one half. z: positive where {} "
                  "has the larger values. Left out: strata with one group, or with all values equal. Holm: over {} "
                  "figures.",
                  data.better.empty() ? "a group" : data.better, data.groups[0], data.groups[0], results.size()));
  report.methods = fmt::format(
      "Groups were compared within the strata of \"{}\" by van Elteren's stratified rank sum test (normal "
      "approximation, corrected for ties); p values were adjusted by Holm's method.",
      choices.strata);
}

namespace {

/// The occasions' names: the first at which the figure has values, and what the terms of later ones are about.
std::vector<std::string> occasionsOf(const DesignData& data, const DesignFigure& figure) {
  if (data.numbered) return {"the first", "each " + data.occasionWord};
  std::vector<std::string> names;
  for (std::size_t o = 0; o < data.occasions.size(); ++o) {
    const auto isThen = [o](const DesignValue& v) { return v.occasion == o; };
    if (std::any_of(figure.values.begin(), figure.values.end(), isThen)) names.push_back(data.occasions[o]);
  }
  return names;
}

ValueTree overallTree(const Expected<RandomIntercept>& overall) {
  return treeOf(overall, [](const RandomIntercept& r) {
    return ValueTree{{"difference", r.estimate},
                     {"error", r.error},
                     {"df", r.df},
                     {"p", r.p},
                     {"interval", r.interval},
                     {"between_variance", r.betweenVariance},
                     {"within_variance", r.withinVariance}};
  });
}

/// Changes of the participants, by group, and with strata within these. @param of what they are changes to or over
Expected<ValueTree> changeTree(const DesignData& data, const std::vector<ParticipantValue>& changes,
                               const std::string& of) {
  std::vector<std::vector<double>> groups(2);
  std::vector<Stratum> strata(data.strata.size());
  for (const ParticipantValue& c : changes) {
    const DesignPerson& person = data.people[c.participant];
    groups[person.group].push_back(c.value);
    if (!strata.empty()) (person.group == 0 ? strata[person.stratum].x : strata[person.stratum].y).push_back(c.value);
  }
  const Expected<BrunnerMunzel> test = brunnerMunzel(groups[0], groups[1]);
  if (!test) return NoResult{test.reason()};
  ValueTree tree{{"of", of}, {"groups", ValueTree::array()}};
  for (std::size_t g = 0; g < 2; ++g) tree["groups"].push_back(medianTree(data.groups[g], groups[g]));
  tree.update({{"shift", *hodgesLehmann(groups[0], groups[1])},
               {"shift_interval", treeOf(hodgesLehmannInterval(groups[0], groups[1]),
                                         [](const ShiftInterval& i) {
                                           return ValueTree{{"lower", i.lower}, {"upper", i.upper}};
                                         })},
               {"a", superiority(groups[0], groups[1])->a},
               {"p", test->p},
               {"exact", test->exact},
               {"smallest_p", mannWhitney(groups[0], groups[1])->smallestP}});
  if (strata.empty()) return Expected<ValueTree>(std::move(tree));
  const Expected<StratifiedRankSum> within = stratifiedRankSum(strata);
  if (!within) return NoResult{within.reason()};
  tree.update({{"a", within->a}, {"p", within->p}, {"exact", false}, {"smallest_p", nullptr}});
  return Expected<ValueTree>(std::move(tree));
}

std::string root(const ValueTree& variance) {
  return variance.is_number() ? significant(std::sqrt(variance.get<double>())) : "-";
}

}  // namespace

void analyseRepeated(const DesignData& data, const DesignChoices& choices, DesignReport& report) {
  ValueTree changes = ValueTree::array();
  const ValueTree& results = analyseFigures(data, report, [&](const DesignFigure& figure) {
    std::vector<OccasionValue> values;
    std::vector<ModelAttempt> attempts;
    for (const DesignValue& v : figure.values) {
      const DesignPerson& person = data.people[v.person];
      double occasion = static_cast<double>(v.occasion);
      if (data.numbered && data.source == "table") occasion = std::stod(data.occasions[v.occasion]);
      values.push_back({v.person, occasion, v.value});
      attempts.push_back({v.person, person.group == 0, person.stratum, v.value});
    }
    const auto lists = personalChanges(values, data.numbered ? OccasionKind::number : OccasionKind::named);
    if (lists.empty()) return Expected<ValueTree>(NoResult{"there is one occasion only"});
    const std::vector<std::string> occasions = occasionsOf(data, figure);
    std::string reason;
    const std::size_t before = changes.size();
    for (std::size_t c = 0; c < lists.size(); ++c) {
      const std::string& of = occasions.at(c + 1);
      const Expected<ValueTree> change = changeTree(data, lists[c], of);
      if (change) {
        changes.push_back({{"figure", figure.name}, {"unit", figure.unit}});
        changes.back().update(*change);
      } else {
        reason = fmt::format("its change, {}: {}", of, change.reason());
        if (lists.size() > 1) report.refused.emplace_back(figure.name, reason);
      }
    }
    if (changes.size() == before) return Expected<ValueTree>(NoResult{reason});
    return Expected<ValueTree>(ValueTree{
        {"attempts", values.size()}, {"first", occasions.at(0)}, {"overall", overallTree(randomIntercept(attempts))}});
  });
  addHolm(changes);
  report.json["changes"] = changes;
  report.tables = {
      tableOf(fmt::format("Change of each participant: {} against {}", data.groups[0], data.groups[1]), changes,
              {{"=figure", "", figureTitle},
               {"=of", "/of", plain},
               {data.groups[0], "/groups/0", quartilesText},
               {data.groups[1], "/groups/1", quartilesText},
               {"shift", "/shift", figure4},
               {"95 %", "/shift_interval", figureRange4},
               {"A", "/a", share3},
               {"p", "/p", pValue},
               {"Holm", "/p_holm", pValue},
               {"smallest", "/smallest_p", pValue}}),
      tableOf("Over all attempts", results,
              {{"=figure", "", figureTitle},
               {"attempts", "/attempts", plain},
               {"sd between", "/overall/between_variance", root},
               {"sd within", "/overall/within_variance", root},
               {"difference", "/overall/difference", digits4},
               {"95 %", "/overall/interval", range4},
               {"p", "/overall/p", pValue}})};
  report.notes.push_back(fmt::format(
      "Change: {}. Who has no such change is left out. A: chance that the change of one of {} is the larger one (a "
      "fall "
      "is negative). shift: {} - {}. p: Brunner and Munzel's test, since changes over few attempts scatter more. Holm: "
      "over the {} changes. Difference: {} less {} over all attempts, without occasion.",
      data.numbered
          ? fmt::format("slope of a participant's values over the number of the {}", data.occasionWord)
          : fmt::format("difference from \"{}\", the first \"{}\"", plain(results[0]["first"]), data.occasionWord),
      data.groups[0], data.groups[0], data.groups[1], changes.size(), data.groups[0], data.groups[1]));
  report.methods = fmt::format(
      "Changes of the participants ({}) were compared by {}; p values were adjusted by Holm's method. The difference "
      "over all attempts is that of a mixed model with a random intercept for each participant, by restricted maximum "
      "likelihood.",
      data.numbered ? "least-squares slopes" : "differences from the first occasion",
      data.strata.empty()
          ? "Brunner and Munzel's test (the larger p of its permutation and Student's t), with the Hodges-Lehmann shift"
          : fmt::format("van Elteren's test within the strata of \"{}\"", choices.strata));
}

}  // namespace calot::analytics
