// SPDX-License-Identifier: GPL-3.0-or-later
// Two groups over repeated attempts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "analytics/design/design_report.h"
#include "analytics/statistics/mixed_models.h"
#include "analytics/statistics/rank_tests.h"

namespace calot::analytics {
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
