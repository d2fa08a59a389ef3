// SPDX-License-Identifier: GPL-3.0-or-later
// Three or more independent groups; two groups compared within strata, such as sites, or over repeated attempts.

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <utility>

#include "analytics/design/design_report.h"
#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/mixed_models.h"
#include "analytics/statistics/rank_tests.h"
#include "analytics/statistics/two_groups.h"

namespace calot::analytics {
namespace {

/// Median and quartiles of a group.
std::string quartilesText(const ValueTree& group) {
  return fmt::format("{} [{}, {}]", digits4(group["median"]), digits4(group["lower_quartile"]),
                     digits4(group["upper_quartile"]));
}

ValueTree severalTree(const DesignData& data, const std::vector<std::vector<double>>& values,
                      const KruskalWallis& test) {
  ValueTree groups = ValueTree::array(), pairs = ValueTree::array();
  for (std::size_t g = 0; g < values.size(); ++g) {
    groups.push_back({{"group", data.groups[g]},
                      {"n", values[g].size()},
                      {"median", *median(values[g])},
                      {"lower_quartile", *quantile(values[g], 0.25)},
                      {"upper_quartile", *quantile(values[g], 0.75)}});
  }
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
    return Expected<ValueTree>(ValueTree{{"n", each.person.size()},
                                         {"strata", test->strata},
                                         {"strata_left_out", test->left},
                                         {"a", test->a},
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
                                   {"z", "/z", signed2},
                                   {"p", "/p", pValue},
                                   {"Holm", "/p_holm", pValue}}));
  report.notes.push_back(
      fmt::format("A: chance that a value of {} is larger than one of {} of the same stratum, ties counting one half. "
                  "Left out: strata with one group, or with all values equal. Holm: over {} figures.",
                  data.groups[0], data.groups[1], results.size()));
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

ValueTree termTree(const ModelTerm& term) {
  return {{"estimate", term.estimate}, {"error", term.error}, {"t", term.t}, {"df", term.df}, {"p", term.p},
          {"interval", term.interval}};
}

ValueTree termsTree(const std::vector<ModelTerm>& terms, const std::vector<std::string>& occasions) {
  ValueTree tree = ValueTree::array();
  for (std::size_t s = 0; s < terms.size(); ++s) {
    tree.push_back(termTree(terms[s]));
    tree.back()["of"] = occasions[s + 1];
  }
  return tree;
}

ValueTree repeatedTree(const RepeatedGroups& m, const Expected<RandomIntercept>& overall,
                       const std::vector<std::string>& occasions) {
  return {{"participants", m.participants},
          {"attempts", m.attempts},
          {"group", termTree(m.group)},
          {"occasion", termsTree(m.occasion, occasions)},
          {"interaction", termsTree(m.interaction, occasions)},
          {"between_variance", m.betweenVariance},
          {"within_variance", m.withinVariance},
          {"restricted_log_likelihood", m.restrictedLogLikelihood},
          {"overall", treeOf(overall, [](const RandomIntercept& r) {
             return ValueTree{
                 {"difference", r.estimate}, {"error", r.error}, {"df", r.df}, {"p", r.p}, {"interval", r.interval}};
           })}};
}

void addTerm(ReportTable& table, std::string& figure, const std::string& name, const ValueTree& term,
             const std::string& adjusted) {
  table.rows.push_back({std::exchange(figure, ""), name, digits4(term["estimate"]), range4(term["interval"]),
                        share2(term["t"]), digits4(term["df"]), pValue(term["p"]), adjusted});
}

std::string root(const ValueTree& variance) { return significant(std::sqrt(variance.get<double>())); }

}  // namespace

void analyseRepeated(const DesignData& data, const DesignChoices& choices, DesignReport& report) {
  std::vector<std::string> first;  // occasion, of each result
  std::vector<double> p;
  const ValueTree& results = analyseFigures(data, report, [&](const DesignFigure& figure) {
    std::vector<OccasionValue> values;
    std::vector<ModelAttempt> attempts;
    std::vector<std::size_t> sites;
    for (const DesignValue& v : figure.values) {
      const DesignPerson& person = data.people[v.person];
      double occasion = static_cast<double>(v.occasion);
      if (data.numbered && data.source == "table") occasion = std::stod(data.occasions[v.occasion]);
      values.push_back({v.person, person.group == 0, occasion, v.value});
      attempts.push_back({v.person, person.group == 0, person.stratum, v.value});
      if (!data.strata.empty()) sites.push_back(person.stratum);
    }
    const Expected<RepeatedGroups> model =
        repeatedGroups(values, data.numbered ? OccasionKind::number : OccasionKind::named, sites);
    if (!model) return Expected<ValueTree>(NoResult{model.reason()});
    const std::vector<std::string> occasions = occasionsOf(data, figure);
    first.push_back(occasions.at(0));
    for (const ModelTerm& term : model->interaction) p.push_back(term.p);
    return Expected<ValueTree>(repeatedTree(*model, randomIntercept(attempts), occasions));
  });
  const Expected<std::vector<double>> adjusted = holm(p);
  ReportTable table =
      tableOf("Group, occasion and interaction", {"=figure", "=term", "estimate", "95 %", "t", "df", "p", "Holm"});
  const std::string both = fmt::format("{} less {}", data.groups[0], data.groups[1]);
  std::size_t next = 0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    std::string title = figureTitle(results[i]);
    addTerm(table, title, fmt::format("{}, at {}", both, first[i]), results[i]["group"], "");
    for (const ValueTree& term : results[i]["occasion"])
      addTerm(table, title, fmt::format("{}, {}", plain(term["of"]), data.groups[1]), term, "");
    for (const ValueTree& term : results[i]["interaction"])
      addTerm(table, title, fmt::format("{}, {}", plain(term["of"]), both), term,
              adjusted ? pText((*adjusted)[next++]) : "-");
  }
  report.tables = {std::move(table), tableOf("Variances", results,
                                             {{"=figure", "", figureTitle},
                                              {"participants", "/participants", plain},
                                              {"attempts", "/attempts", plain},
                                              {"sd between", "/between_variance", root},
                                              {"sd within", "/within_variance", root},
                                              {"difference overall", "/overall/difference", digits4},
                                              {"95 %", "/overall/interval", range4},
                                              {"p", "/overall/p", pValue}})};
  report.notes.push_back(fmt::format(
      "Occasion: {}. The interaction is by how much the groups' changes differ; Holm: over the {} interactions. "
      "Difference overall: {} less {} over all attempts, without occasion.",
      data.numbered ? fmt::format("the number of the {}, one slope, counted from the first", data.occasionWord)
                    : fmt::format("\"{}\", each against the first", data.occasionWord),
      p.size(), data.groups[0], data.groups[1]));
  report.methods = fmt::format(
      "Group, occasion and their interaction were estimated by a mixed model with a random intercept for each "
      "participant, by restricted maximum likelihood, with Student's t and the degrees of freedom of inner and outer "
      "terms{}. The interactions' p values were adjusted by Holm's method.",
      data.strata.empty() ? "" : fmt::format("; the strata of \"{}\" had constants of their own", choices.strata));
}

}  // namespace calot::analytics
