// SPDX-License-Identifier: GPL-3.0-or-later
// Repeatability of figures over attempts or raters: variance components, decisions, error of measurement.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <span>

#include "analytics/design/design_report.h"
#include "analytics/report/report_document.h"
#include "analytics/statistics/reliability.h"
#include "recorder/base/errors.h"

namespace calot::analytics {
namespace {

constexpr std::size_t mostDecisions = 6;
constexpr std::size_t shareResamples = 1999;  ///< every figure has some

using CrossedValues = std::map<std::size_t, std::map<std::size_t, double>>;  ///< by person, by level of the facet

/// @throws Error (refused) for two values of a person at one level.
CrossedValues crossedValues(const DesignData& data, const DesignFigure& figure, const std::string& facet,
                            const std::vector<std::string>& levels) {
  CrossedValues values;
  for (const DesignValue& v : figure.values) {
    if (!values[v.person].emplace(v.occasion, v.value).second)
      throw Error(ErrorKind::refused, Where{data.where},
                  fmt::format("participant \"{}\" has two values of {} at {} {}", data.people[v.person].name,
                              figure.name, facet, levels[v.occasion]));
  }
  return values;
}

/// Levels of the variance components, and the people who have all of them.
struct CrossedTable {
  RatingTable table;
  std::size_t incomplete = 0;  ///< people left out
};

/// @param leading the first levels alone, as many as at least half of the people with two have; else all
CrossedTable completeTable(const CrossedValues& values, std::size_t levels, bool leading) {
  std::size_t used = levels;
  if (leading) {
    std::vector<std::size_t> reach;  // how many of the first levels a person has without a gap
    for (const auto& item : values) {
      std::size_t k = 0;
      while (item.second.count(k) > 0) ++k;
      if (k > 1) reach.push_back(k);
    }
    std::sort(reach.begin(), reach.end());
    used = reach.empty() ? 0 : reach[reach.size() / 2];
  }
  CrossedTable result;
  result.table.raters = used;
  for (const auto& item : values) {
    std::vector<double> row;
    for (std::size_t level = 0; level < used; ++level) {
      const auto at = item.second.find(level);
      if (at != item.second.end()) row.push_back(at->second);
    }
    if (row.size() < used || used == 0) {
      ++result.incomplete;
      continue;
    }
    ++result.table.subjects;
    result.table.values.insert(result.table.values.end(), row.begin(), row.end());
  }
  return result;
}

ValueTree componentsTree(const DesignFigure& figure, const std::string& facet, const Generalizability& g,
                         const CrossedTable& crossed, const std::string& of) {
  ValueTree decisions = ValueTree::array();
  for (std::size_t k = 1; k <= std::max(mostDecisions, g.levels); ++k) {
    const DecisionStudy d = g.at(k);
    decisions.push_back({{"k", k},
                         {"g", d.g},
                         {"phi", d.phi},
                         {"relative_error", d.relativeError},
                         {"absolute_error", d.absoluteError}});
  }
  return {{"figure", figure.name},
          {"unit", figure.unit},
          {"facet", facet},
          {"of", of},
          {"people", g.people},
          {"levels", g.levels},
          {"left_out", crossed.incomplete},
          {"person_variance", g.person},
          {"facet_variance", g.facet},
          {"residual_variance", g.residual},
          {"group_variance", g.group},
          {"common_variance", g.common},
          {"interaction_variance", g.interaction},
          {"truncated", g.truncated},
          {"decisions", decisions},
          {"g_interval", g.gInterval},
          {"phi_interval", g.groups > 1
                               ? ValueTree(nullptr)
                               : treeOf(intraclassCorrelation(crossed.table, IccForm::twoAverage),
                                        [](const IntraclassCorrelation& icc) { return ValueTree(icc.interval); })}};
}

ValueTree shareTree(const VarianceShare& share) {
  return {{"share", share.value},
          {"interval", treeOf(share.interval, [](const Interval& interval) { return ValueTree(interval); })}};
}

/// Shares of people nested in groups, with intervals; or the reason for their absence.
ValueTree sharesTree(const DesignFigure& figure, const std::string& facet, std::span<const RatingTable> groups,
                     const BootstrapOptions& bootstrap) {
  ValueTree row{{"figure", figure.name}, {"unit", figure.unit}, {"facet", facet}, {"seed", bootstrap.seed}};
  row["resamples"] = bootstrap.resamples;
  const Expected<LevelShares> shares = levelShares(groups, bootstrap);
  if (!shares) {
    row["reason"] = shares.reason();
    return row;
  }
  row["level"] = shareTree(shares->level);
  row["common"] = shareTree(shares->common);
  row["interaction"] = shareTree(shares->interaction);
  row["residual"] = shareTree(shares->residual);
  return row;
}

/// A share in per cent with its interval, where there is one.
std::string percentText(const ValueTree& row, const char* of) {
  if (!row.contains(of)) return "-";
  const ValueTree &share = row[of], &interval = share["interval"];
  const std::string value = fmt::format("{:.1f} %", 100.0 * share["share"].get<double>());
  if (!interval.contains("lower")) return value;
  return fmt::format("{} [{:.1f}, {:.1f}]", value, 100.0 * interval["lower"].get<double>(),
                     100.0 * interval["upper"].get<double>());
}

/// A variance and its share of all.
std::string shareText(const ValueTree& row, const char* of) {
  const double variance = row.at(of), total = row["person_variance"].get<double>() +
                                              row["facet_variance"].get<double>() +
                                              row["residual_variance"].get<double>();
  return fmt::format("{} ({:.0f} %)", significant(variance, 3), total > 0.0 ? 100.0 * variance / total : 0.0);
}

/// A coefficient of all levels with its interval, where there is one.
std::string coefficientText(const ValueTree& row, const std::string& of) {
  const ValueTree &interval = row[of + "_interval"], &all = row["decisions"][row["levels"].get<std::size_t>() - 1];
  return share2(all[of]) + (interval.contains("lower") ? " " + shares2(interval) : "");
}

constexpr const char* allPeople = "all";

/// The figure of one group's people.
DesignFigure within(const DesignData& data, const DesignFigure& figure, std::size_t group) {
  DesignFigure part = figure;
  std::erase_if(part.values, [&](const DesignValue& v) { return data.people[v.person].group != group; });
  return part;
}

/// Components of all people, then, where there are groups, of people nested in groups and of each group.
/// @returns whether the figure has components of all
bool addComponents(const DesignData& data, const DesignFigure& figure, const std::string& facet,
                   const std::vector<std::string>& levels, bool leading, DesignReport& report) {
  const auto crossedOf = [&](const DesignFigure& of, std::size_t most, bool first) {
    return completeTable(crossedValues(data, of, facet, levels), most, first);
  };
  const CrossedTable all = crossedOf(figure, levels.size(), leading);
  const auto add = [&](const CrossedTable& crossed, std::span<const RatingTable> tables, const std::string& of) {
    const Expected<Generalizability> g = generalizability(tables);
    if (!g) {
      report.refused.emplace_back(
          fmt::format("variance components of {} over {}s ({})", figure.name, facet, of),
          crossed.table.subjects < 2 ? "fewer than two participants have values at all of them" : g.reason());
      return false;
    }
    if (g->truncated)
      report.notes.push_back(fmt::format(
          "{} ({}): a negative variance component was set to 0; there are too few data for it.", figure.name, of));
    report.json["components"].push_back(componentsTree(figure, facet, *g, crossed, of));
    return true;
  };
  if (!add(all, {&all.table, 1}, allPeople)) return false;
  std::vector<CrossedTable> groups;
  std::vector<RatingTable> tables;
  for (std::size_t g = 0; data.groups.size() > 1 && g < data.groups.size(); ++g) {
    groups.push_back(crossedOf(within(data, figure, g), all.table.raters, false));
    if (groups.back().table.subjects > 1) tables.push_back(groups.back().table);
  }
  if (tables.size() > 1 && add(all, tables, "within groups"))
    report.json["shares"].push_back(sharesTree(figure, facet, tables, {.resamples = shareResamples}));
  for (std::size_t g = 0; g < groups.size(); ++g) add(groups[g], {&groups[g].table, 1}, data.groups[g]);
  return true;
}

/// @returns whether the figure has an error of measurement
bool addError(const DesignFigure& figure, const std::string& of, DesignReport& report,
              std::vector<std::string>& warnings) {
  std::vector<RepeatedValue> values;
  for (const DesignValue& v : figure.values) values.push_back({v.person, v.order, v.value});
  const Expected<MeasurementError> e = measurementError(values);
  if (!e) {
    report.refused.emplace_back(fmt::format("error of measurement of {} ({})", figure.name, of), e.reason());
    return false;
  }
  report.json["measurement_error"].push_back({{"figure", figure.name},
                                              {"unit", figure.unit},
                                              {"of", of},
                                              {"people", e->people},
                                              {"attempts", e->attempts},
                                              {"df", e->df},
                                              {"sem", e->sem},
                                              {"sem_interval", e->semInterval},
                                              {"sdc", e->sdc},
                                              {"sdc_interval", e->sdcInterval}});
  const std::string text = coverageWarning(CoveredInterval::sdc, "SEM and SDC", e->people, e->people, "participants");
  if (!text.empty() && std::find(warnings.begin(), warnings.end(), text) == warnings.end()) warnings.push_back(text);
  return true;
}

}  // namespace

void analyseReliability(const DesignData& data, const DesignChoices&, DesignReport& report) {
  std::vector<std::string> warnings;
  for (const char* key : {"measurement_error", "components", "shares"}) report.json[key] = ValueTree::array();
  std::size_t analysed = 0;
  const bool leading = data.source == "cohort" || data.occasionWord == "row";
  for (const DesignFigure& figure : data.figures) {
    if (addError(figure, allPeople, report, warnings)) ++analysed;
    for (std::size_t g = 0; data.groups.size() > 1 && g < data.groups.size(); ++g)
      addError(within(data, figure, g), data.groups[g], report, warnings);
    if (addComponents(data, figure, data.occasionWord, data.occasions, leading, report)) ++analysed;
  }
  for (const DesignFigure& form : data.rated) {
    if (addComponents(data, form, "rater", data.raters, false, report)) ++analysed;
  }
  askForResults(data, report, analysed);
  std::vector<TreeColumn> decisions{{"=figure", "", figureTitle}, {"=facet", "/facet", plain}, {"=of", "/of", plain}};
  for (std::size_t k = 1; k <= mostDecisions; ++k)
    decisions.push_back({fmt::format("{}", k), fmt::format("/decisions/{}", k - 1),
                         [](const ValueTree& d) { return share2(d["g"]) + " / " + share2(d["phi"]); }});
  const ValueTree& components = report.json["components"];
  for (ReportTable table :
       {tableOf("Error of measurement", report.json["measurement_error"],
                {{"=figure", "", figureTitle},
                 {"=of", "/of", plain},
                 {"people", "/people", plain},
                 {"attempts", "/attempts", plain},
                 {"SEM", "/sem", digits4},
                 {"95 %", "/sem_interval", range4},
                 {"SDC", "/sdc", digits4},
                 {"95 %", "/sdc_interval", range4}}),
        tableOf("Variance components", components,
                {{"=figure", "", figureTitle},
                 {"=facet", "/facet", plain},
                 {"=of", "/of", plain},
                 {"people", "/people", plain},
                 {"left out", "/left_out", plain},
                 {"levels", "/levels", plain},
                 {"person", "", [](const ValueTree& row) { return shareText(row, "person_variance"); }},
                 {"facet", "", [](const ValueTree& row) { return shareText(row, "facet_variance"); }},
                 {"residual", "", [](const ValueTree& row) { return shareText(row, "residual_variance"); }},
                 {"G [95 %]", "", [](const ValueTree& row) { return coefficientText(row, "g"); }},
                 {"Phi [95 %]", "", [](const ValueTree& row) { return coefficientText(row, "phi"); }}}),
        tableOf("Shares of the variance within groups [95 %]", report.json["shares"],
                {{"=figure", "", figureTitle},
                 {"=facet", "/facet", plain},
                 {"facet and residual", "", [](const ValueTree& row) { return percentText(row, "level"); }},
                 {"facet, all alike", "", [](const ValueTree& row) { return percentText(row, "common"); }},
                 {"facet x group", "", [](const ValueTree& row) { return percentText(row, "interaction"); }},
                 {"residual", "", [](const ValueTree& row) { return percentText(row, "residual"); }}}),
        tableOf("Decision study: G / Phi of the mean of N", components, decisions)}) {
    if (!table.rows.empty()) report.tables.push_back(std::move(table));
  }
  report.notes.emplace_back(
      "SEM: standard deviation of one participant's attempts, in the figure's unit; SDC: a change of one participant "
      "below it, 1.96 sqrt(2) SEM, may be chance. Learning from attempt to attempt counts as error in both.");
  report.notes.emplace_back(
      "G: how reliably participants are ranked, Phi: how reliably they are held against a mark, by the mean of all "
      "levels "
      "of the facet. Left out: participants without values at all of these levels.");
  if (data.groups.size() > 1)
    report.notes.emplace_back(
        "all: in a mixture of groups that differ, G and Phi are larger than within a group, since differences between "
        "groups count as differences between people. within groups: people nested in groups. Where a score grades "
        "people of one group, its own row counts. Shares within groups: what is not of people is the facet's, in all "
        "groups alike or in one and not in another, or the residual, what it changes in one person and not in "
        "another.");
  for (const std::string& warning : warnings) report.notes.push_back("Warning: " + warning + ".");
  report.methods =
      "The error of measurement is the pooled deviation of participants' attempts about their own means, with "
      "intervals "
      "from chi-squared. Variance components of participants by facet are those of the two-way analysis of variance of "
      "complete data, pooled within groups for people nested in groups; G and Phi have the intervals of ICC(3,k) and "
      "ICC(2,k), shares within groups those of a percentile bootstrap over people within their groups.";
}

}  // namespace calot::analytics
