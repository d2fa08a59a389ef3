// SPDX-License-Identifier: GPL-3.0-or-later
// Two devices or methods that measured the same people, and figures against another, such as a rating (concurrent
// validity).
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>

#include "analytics/design/design_report.h"
#include "analytics/report/report_document.h"
#include "analytics/statistics/rank_tests.h"
#include "analytics/statistics/reliability.h"
#include "recorder/base/errors.h"

namespace calot::analytics {
namespace {

/// Values of two figures, value i of both the same participant's.
struct FigurePairs {
  std::vector<double> first, second;
};

/// Pairs of participants who have both values. @pre one value each
FigurePairs pairsOf(const DesignFigure& first, const DesignFigure& second) {
  const OneEach a = oneEachOf(first), b = oneEachOf(second);
  std::map<std::size_t, double> other;
  for (std::size_t i = 0; i < b.person.size(); ++i) other[b.person[i]] = b.value[i];
  FigurePairs pairs;
  for (std::size_t i = 0; i < a.person.size(); ++i) {
    const auto at = other.find(a.person[i]);
    if (at == other.end()) continue;
    pairs.first.push_back(a.value[i]);
    pairs.second.push_back(at->second);
  }
  return pairs;
}

/// The figure that others are held against, by its name or its checkpoint's.
/// @throws Error (invalid) unless it is exactly one.
const DesignFigure& againstOf(const DesignData& data, const std::string& asked) {
  // Behind a column's name may stand what is better.
  const std::size_t colon = asked.rfind(':');
  const bool whole = colon == std::string::npos || std::any_of(data.figures.begin(), data.figures.end(),
                                                               [&](const auto& f) { return f.name == asked; });
  const std::string against = whole ? asked : asked.substr(0, colon);
  const DesignFigure* found = nullptr;
  std::size_t count = 0;
  for (const DesignFigure& f : data.figures) {
    if (f.name == against) return f;
    if (f.name.rfind(against + " ", 0) == 0) {
      found = &f;
      ++count;
    }
  }
  if (count == 1) return *found;
  throw Error(ErrorKind::invalid, Where{data.where},
              count == 0 ? fmt::format("the figure \"{}\" to hold others against has no value", against)
                         : fmt::format("\"{}\" is {} figures, name one of them whole", against, count));
}

/// Pairs of one comparison and what they are called.
struct Comparison {
  std::string title, first, second, unit;
  FigurePairs pairs;
};

/// The figure at two occasions: of each participant who has both.
FigurePairs pairsAtOccasions(const DesignFigure& figure) {
  std::map<std::size_t, std::map<std::size_t, std::pair<double, std::size_t>>> values;
  for (const DesignValue& v : figure.values) {
    auto& [sum, count] = values[v.person][v.occasion];
    sum += v.value;
    ++count;
  }
  FigurePairs pairs;
  for (const auto& item : values) {
    if (item.second.size() != 2) continue;
    const auto mean = [](const std::pair<double, std::size_t>& v) { return v.first / static_cast<double>(v.second); };
    pairs.first.push_back(mean(item.second.begin()->second));
    pairs.second.push_back(mean(std::next(item.second.begin())->second));
  }
  return pairs;
}

std::vector<Comparison> comparisonsOf(const DesignData& data, const DesignChoices& choices) {
  std::vector<Comparison> comparisons;
  if (!choices.against.empty()) {
    const DesignFigure& against = againstOf(data, choices.against);
    for (const DesignFigure& f : data.figures) {
      if (&f != &against)
        comparisons.push_back({f.name + " - " + against.name, f.name, against.name, f.unit, pairsOf(f, against)});
    }
    return comparisons;
  }
  if (data.occasions.size() != 2) {
    std::string list;
    for (const std::string& o : data.occasions) list += (list.empty() ? "" : ", ") + o;
    throw Error(ErrorKind::refused, Where{data.where},
                fmt::format("agreement is between two: of \"{}\" there are {} ({})", data.occasionWord,
                            data.occasions.size(), list));
  }
  for (const DesignFigure& f : data.figures)
    comparisons.push_back({f.name, data.occasions[0], data.occasions[1], f.unit, pairsAtOccasions(f)});
  return comparisons;
}

std::optional<Drawing> differencePlot(const Comparison& c, const BlandAltman& r, bool synthetic) {
  PlotSeries points{"", 0, {}, false, false};
  for (std::size_t i = 0; i < c.pairs.first.size(); ++i)
    points.points.emplace_back(0.5 * (c.pairs.first[i] + c.pairs.second[i]), c.pairs.first[i] - c.pairs.second[i]);
  return drawLines(
      {c.title, c.unit, "mean of both; dashed: bias and limits", {points}, {r.lower, r.bias, r.upper}, synthetic});
}

ValueTree agreementTree(const Comparison& c, const BlandAltman& r, const Expected<DemingRegression>& line) {
  return {{"figure", c.title},
          {"first", c.first},
          {"second", c.second},
          {"unit", c.unit},
          {"pairs", r.pairs},
          {"bias", r.bias},
          {"bias_interval", r.biasInterval},
          {"sd", r.deviation},
          {"lower_limit", r.lower},
          {"lower_limit_interval", r.lowerInterval},
          {"upper_limit", r.upper},
          {"upper_limit_interval", r.upperInterval},
          {"deming", treeOf(line, [](const DemingRegression& d) {
             return ValueTree{{"slope", d.slope},
                              {"slope_error", d.slopeError},
                              {"slope_interval", d.slopeInterval},
                              {"intercept", d.intercept},
                              {"intercept_error", d.interceptError},
                              {"intercept_interval", d.interceptInterval}};
           })}};
}

/// Tests whether the scatter of the differences grows with the measured quantity.
std::optional<Spearman> scatterOf(const FigurePairs& pairs) {
  std::vector<double> size, apart;
  for (std::size_t i = 0; i < pairs.first.size(); ++i) {
    size.push_back(0.5 * (pairs.first[i] + pairs.second[i]));
    apart.push_back(std::abs(pairs.first[i] - pairs.second[i]));
  }
  return spearman(apart, size).optional();
}

}  // namespace

void analyseAgreement(const DesignData& data, const DesignChoices& choices, DesignReport& report) {
  std::vector<std::string> warnings, scatters;
  ValueTree& results = report.json["results"] = ValueTree::array();
  for (const Comparison& c : comparisonsOf(data, choices)) {
    const Expected<BlandAltman> r = blandAltman(c.pairs.first, c.pairs.second);
    if (!r) {
      report.refused.emplace_back(c.title, r.reason());
      continue;
    }
    const Expected<DemingRegression> line = demingRegression(c.pairs.first, c.pairs.second, choices.errorRatio);
    const std::optional<Spearman> scatter = scatterOf(c.pairs);
    scatters.push_back(scatter ? fmt::format("{:+.2f} (p {})", scatter->rho, pText(scatter->p)) : "-");
    if (!line) report.refused.emplace_back("Deming's line of " + c.title, line.reason());
    if (scatter && scatter->rho > 0.0 && scatter->p <= usualLevel)
      warnings.push_back(
          fmt::format("Warning: differences of {} grow with the size of the values; limits that hold for "
                      "all sizes do not describe them.",
                      c.title));
    for (const auto& [interval, name] : {std::pair{CoveredInterval::limits, "limits of agreement"},
                                         std::pair{CoveredInterval::deming, "Deming's slope"}}) {
      const std::string text = coverageWarning(interval, name, r->pairs, r->pairs, "pairs");
      if (!text.empty() && std::find(warnings.begin(), warnings.end(), "Warning: " + text + ".") == warnings.end())
        warnings.push_back("Warning: " + text + ".");
    }
    results.push_back(agreementTree(c, *r, line));
    if (std::optional<Drawing> drawing = differencePlot(c, *r, data.synthetic))
      report.drawings.push_back(std::move(*drawing));
  }
  askForResults(data, report, results.size());
  ReportTable limits = tableOf("Limits of agreement", results,
                               {{"=difference", "", figureTitle},
                                {"pairs", "/pairs", plain},
                                {"bias", "/bias", digits4},
                                {"95 %", "/bias_interval", range4},
                                {"sd", "/sd", digits4},
                                {"lower", "/lower_limit", digits4},
                                {"95 %", "/lower_limit_interval", range4},
                                {"upper", "/upper_limit", digits4},
                                {"95 %", "/upper_limit_interval", range4},
                                {"rho of scatter", "/scatter", plain}});
  for (std::size_t i = 0; i < scatters.size(); ++i) limits.rows[i].back() = scatters[i];
  report.tables = {std::move(limits), tableOf("Deming regression", results,
                                              {{"=second on first", "", figureTitle},
                                               {"slope", "/deming/slope", digits4},
                                               {"95 %", "/deming/slope_interval", range4},
                                               {"intercept", "/deming/intercept", digits4},
                                               {"95 %", "/deming/intercept_interval", range4}})};
  report.notes.push_back(
      choices.against.empty()
          ? fmt::format("Differences: {} less {}, of participants with both.", data.occasions[0], data.occasions[1])
          : std::string("Differences: the first less the second, of participants with both."));
  report.notes.emplace_back(
      "95 % of differences are expected within the limits; whether these are narrow enough is a question of use, not "
      "of a "
      "test. rho of scatter: Spearman's correlation of the absolute difference with the mean.");
  for (const std::string& warning : warnings) report.notes.push_back(warning);
  report.methods = fmt::format(
      "Agreement is described by bias and limits of agreement (mean and 1.96 standard deviations of the differences) "
      "with "
      "Student's intervals (Bland and Altman 1999), and by Deming regression with a ratio of error variances of {} and "
      "jackknife intervals (Linnet 1993).",
      significant(choices.errorRatio));
}

void analyseCorrelation(const DesignData& data, const DesignChoices& choices, DesignReport& report) {
  const DesignFigure& against = againstOf(data, choices.against);
  report.json["against"] = against.name;
  ValueTree& results = analyseFigures(
      data, report,
      [&](const DesignFigure& figure) {
        const FigurePairs pairs = pairsOf(figure, against);
        const Expected<Spearman> test = spearman(pairs.first, pairs.second);
        if (!test) return Expected<ValueTree>(NoResult{test.reason()});
        return Expected<ValueTree>(ValueTree{{"n", pairs.first.size()},
                                             {"rho", test->rho},
                                             {"interval", spearmanInterval(test->rho, pairs.first.size())},
                                             {"p", test->p},
                                             {"method", test->exact ? "all orders" : "Student's t"}});
      },
      &against);
  addHolm(results);
  report.tables.push_back(tableOf("Correlation with " + against.name, results,
                                  {{"=figure", "", figureTitle},
                                   {"n", "/n", plain},
                                   {"rho", "/rho", signed3},
                                   {"95 %", "/interval", range4},
                                   {"p", "/p", pValue},
                                   {"Holm", "/p_holm", pValue},
                                   {"=method of p", "/method", plain}}));
  report.notes.push_back(fmt::format(
      "rho: over all participants who have both figures. In a mixture of groups that differ in both it is larger than "
      "within a group. Holm: over {} figures.",
      results.size()));
  report.methods = fmt::format(
      "Figures were correlated with {} by Spearman's rank correlation with the interval of Bonett and Wright; p values "
      "were adjusted by Holm's method.",
      against.name);
}

}  // namespace calot::analytics
