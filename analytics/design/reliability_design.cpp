// SPDX-License-Identifier: GPL-3.0-or-later
// Repeatability of figures over attempts or raters: variance components, decisions, error of measurement.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "analytics/design/design_report.h"
#include "analytics/report/report_text.h"
#include "analytics/statistics/reliability.h"
#include "recorder/base/errors.h"

namespace calot::analytics {
namespace {

constexpr std::size_t mostDecisions = 6;

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

/// Which levels the variance components are of, and the people who have all of them.
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

struct ReliabilityTables {
  ReportTable components, decisions;
};

DesignJson componentsJson(const DesignFigure& figure, const std::string& facet, const Generalizability& g,
                          std::size_t incomplete, const RatingTable& table) {
  DesignJson decisions = DesignJson::array();
  for (std::size_t k = 1; k <= std::max(mostDecisions, g.levels); ++k) {
    const DecisionStudy d = g.at(k);
    decisions.push_back({{"k", k},
                         {"g", d.g},
                         {"phi", d.phi},
                         {"relative_error", d.relativeError},
                         {"absolute_error", d.absoluteError}});
  }
  DesignJson json{{"figure", figure.name},       {"unit", figure.unit},       {"facet", facet},
                  {"people", g.people},          {"levels", g.levels},        {"left_out", incomplete},
                  {"person_variance", g.person}, {"facet_variance", g.facet}, {"residual_variance", g.residual},
                  {"truncated", g.truncated},    {"decisions", decisions}};
  for (const auto& [form, name] :
       {std::pair{IccForm::threeAverage, "g_interval"}, {IccForm::twoAverage, "phi_interval"}}) {
    const Expected<IntraclassCorrelation> icc = intraclassCorrelation(table, form);
    json[name] = !icc            ? reasonJson(icc.reason())
                 : icc->interval ? intervalJson(*icc->interval)
                                 : reasonJson(icc->interval.reason());
  }
  return json;
}

std::string shareText(double variance, double total) {
  return fmt::format("{} ({:.0f} %)", significant(variance, 3), total > 0.0 ? 100.0 * variance / total : 0.0);
}

std::string iccInterval(const RatingTable& table, IccForm form) {
  const Expected<IntraclassCorrelation> icc = intraclassCorrelation(table, form);
  return icc && icc->interval ? fmt::format(" [{:.2f}, {:.2f}]", icc->interval->lower, icc->interval->upper) : "";
}

/// @returns whether the figure has components
bool addComponents(const DesignData& data, const DesignFigure& figure, const std::string& facet,
                   const std::vector<std::string>& levels, bool leading, ReliabilityTables& tables,
                   DesignReport& report, std::vector<std::pair<std::string, std::string>>& refused) {
  const CrossedTable crossed = completeTable(crossedValues(data, figure, facet, levels), levels.size(), leading);
  const Expected<Generalizability> g = generalizability(crossed.table);
  if (!g) {
    refused.emplace_back(
        fmt::format("variance components of {} over {}s", figure.name, facet),
        crossed.table.subjects < 2 ? "fewer than two participants have values at all of them" : g.reason());
    return false;
  }
  const double total = g->person + g->facet + g->residual;
  const DecisionStudy all = g->at(g->levels);
  tables.components.rows.push_back(
      {figureTitle(figure), facet, fmt::format("{}", g->people), fmt::format("{}", crossed.incomplete),
       fmt::format("{}", g->levels), shareText(g->person, total), shareText(g->facet, total),
       shareText(g->residual, total), fmt::format("{:.2f}{}", all.g, iccInterval(crossed.table, IccForm::threeAverage)),
       fmt::format("{:.2f}{}", all.phi, iccInterval(crossed.table, IccForm::twoAverage))});
  std::vector<std::string> cells{figureTitle(figure), facet};
  for (std::size_t k = 1; k <= mostDecisions; ++k) {
    const DecisionStudy d = g->at(k);
    cells.push_back(fmt::format("{:.2f} / {:.2f}", d.g, d.phi));
  }
  tables.decisions.rows.push_back(std::move(cells));
  if (g->truncated)
    report.notes.push_back(
        fmt::format("{}: a negative variance component was set to 0; there are too few data for it.", figure.name));
  report.json["components"].push_back(componentsJson(figure, facet, *g, crossed.incomplete, crossed.table));
  return true;
}

/// @returns whether the figure has an error of measurement
bool addError(const DesignFigure& figure, ReportTable& table, DesignReport& report,
              std::vector<std::pair<std::string, std::string>>& refused, std::vector<std::string>& warnings) {
  std::vector<RepeatedValue> values;
  for (const DesignValue& v : figure.values) values.push_back({v.person, v.order, v.value});
  const Expected<MeasurementError> e = measurementError(values);
  if (!e) {
    refused.emplace_back("error of measurement of " + figure.name, e.reason());
    return false;
  }
  table.rows.push_back({figureTitle(figure), fmt::format("{}", e->people), fmt::format("{}", e->attempts),
                        significant(e->sem), intervalText(e->semInterval), significant(e->sdc),
                        intervalText(e->sdcInterval)});
  report.json["measurement_error"].push_back({{"figure", figure.name},
                                              {"unit", figure.unit},
                                              {"people", e->people},
                                              {"attempts", e->attempts},
                                              {"df", e->df},
                                              {"sem", e->sem},
                                              {"sem_interval", intervalJson(e->semInterval)},
                                              {"sdc", e->sdc},
                                              {"sdc_interval", intervalJson(e->sdcInterval)}});
  const std::string text = coverageWarning(CoveredInterval::sdc, "SEM and SDC", e->people, e->people, "participants");
  if (!text.empty() && std::find(warnings.begin(), warnings.end(), text) == warnings.end()) warnings.push_back(text);
  return true;
}

}  // namespace

void analyseReliability(const DesignData& data, const DesignChoices&, DesignReport& report) {
  ReliabilityTables tables{tableOf("Variance components", {"=figure", "=facet", "people", "left out", "levels",
                                                           "person", "facet", "residual", "G [95 %]", "Phi [95 %]"}),
                           tableOf("Decision study: G / Phi of the mean of so many", {"=figure", "=facet"})};
  for (std::size_t k = 1; k <= mostDecisions; ++k)
    tables.decisions.columns.emplace_back(fmt::format("{}", k), TextTable::Align::right);
  ReportTable errors = tableOf("Error of measurement", {"=figure", "people", "attempts", "SEM", "95 %", "SDC", "95 %"});
  std::vector<std::pair<std::string, std::string>> refused;
  std::vector<std::string> warnings;
  report.json["components"] = report.json["measurement_error"] = DesignJson::array();
  std::size_t analysed = 0;
  const bool leading = data.source == "cohort" || data.occasionWord == "row";
  for (const DesignFigure& figure : data.figures) {
    if (addError(figure, errors, report, refused, warnings)) ++analysed;
    if (addComponents(data, figure, data.occasionWord, data.occasions, leading, tables, report, refused)) ++analysed;
  }
  for (const DesignFigure& form : data.rated) {
    if (addComponents(data, form, "rater", data.raters, false, tables, report, refused)) ++analysed;
  }
  askForResults(data, analysed, refused);
  for (ReportTable table : {std::move(errors), std::move(tables.components), std::move(tables.decisions)}) {
    if (!table.rows.empty()) report.tables.push_back(std::move(table));
  }
  report.notes.emplace_back(
      "SEM: standard deviation of one participant's attempts, in the figure's unit; SDC: a change of one participant "
      "below it, 1.96 sqrt(2) SEM, may be chance. Learning from attempt to attempt counts as error in both.");
  report.notes.emplace_back(
      "G: how reliably participants are ranked, Phi: how reliably they are held against a mark, by the mean of all "
      "levels "
      "of the facet. Left out: participants without values at all of these levels.");
  for (const std::string& warning : warnings) report.notes.push_back("Warning: " + warning + ".");
  noteRefused(report, refused);
  report.methods =
      "The error of measurement is the pooled deviation of participants' attempts about their own means, with "
      "intervals "
      "from chi-squared. Variance components of participants by facet are those of the two-way analysis of variance of "
      "complete data; G and Phi have the intervals of ICC(3,k) and ICC(2,k).";
}

}  // namespace calot::analytics
