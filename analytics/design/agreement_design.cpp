// SPDX-License-Identifier: GPL-3.0-or-later
// Two devices or methods that measured the same people, and figures against another, such as a rating (concurrent
// validity).
#include "analytics/design/agreement_design.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>

#include "analytics/design/design_report.h"
#include "analytics/report/report_text.h"
#include "analytics/statistics/rank_tests.h"
#include "analytics/statistics/reliability.h"
#include "recorder/base/errors.h"

namespace calot::analytics {
namespace {

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

DesignJson agreementJson(const Comparison& c, const BlandAltman& r, const Expected<DemingRegression>& line) {
  DesignJson json{{"figure", c.title},
                  {"first", c.first},
                  {"second", c.second},
                  {"unit", c.unit},
                  {"pairs", r.pairs},
                  {"bias", r.bias},
                  {"bias_interval", intervalJson(r.biasInterval)},
                  {"sd", r.deviation},
                  {"lower_limit", r.lower},
                  {"lower_limit_interval", intervalJson(r.lowerInterval)},
                  {"upper_limit", r.upper},
                  {"upper_limit_interval", intervalJson(r.upperInterval)}};
  json["deming"] = line ? DesignJson{{"slope", line->slope},
                                     {"slope_error", line->slopeError},
                                     {"slope_interval", intervalJson(line->slopeInterval)},
                                     {"intercept", line->intercept},
                                     {"intercept_error", line->interceptError},
                                     {"intercept_interval", intervalJson(line->interceptInterval)}}
                        : reasonJson(line.reason());
  return json;
}

/// Tests whether the scatter of the differences grows with the measured quantity.
std::optional<Spearman> scatterOf(const FigurePairs& pairs) {
  std::vector<double> size, apart;
  for (std::size_t i = 0; i < pairs.first.size(); ++i) {
    size.push_back(0.5 * (pairs.first[i] + pairs.second[i]));
    apart.push_back(std::abs(pairs.first[i] - pairs.second[i]));
  }
  const Expected<Spearman> r = spearman(apart, size);
  return r ? std::optional(*r) : std::nullopt;
}

}  // namespace

void analyseAgreement(const DesignData& data, const DesignChoices& choices, DesignReport& report) {
  ReportTable limits = tableOf("Limits of agreement", {"=difference", "pairs", "bias", "95 %", "sd", "lower", "95 %",
                                                       "upper", "95 %", "rho of scatter"});
  ReportTable lines = tableOf("Deming regression", {"=second on first", "slope", "95 %", "intercept", "95 %"});
  std::vector<std::pair<std::string, std::string>> refused;
  std::vector<std::string> warnings;
  report.json["results"] = DesignJson::array();
  for (const Comparison& c : comparisonsOf(data, choices)) {
    const Expected<BlandAltman> r = blandAltman(c.pairs.first, c.pairs.second);
    if (!r) {
      refused.emplace_back(c.title, r.reason());
      continue;
    }
    const std::string title = c.unit.empty() ? c.title : fmt::format("{} [{}]", c.title, c.unit);
    const Expected<DemingRegression> line = demingRegression(c.pairs.first, c.pairs.second, choices.errorRatio);
    const std::optional<Spearman> scatter = scatterOf(c.pairs);
    limits.rows.push_back({title, fmt::format("{}", r->pairs), significant(r->bias), intervalText(r->biasInterval),
                           significant(r->deviation), significant(r->lower), intervalText(r->lowerInterval),
                           significant(r->upper), intervalText(r->upperInterval),
                           scatter ? fmt::format("{:+.2f} (p {})", scatter->rho, pText(scatter->p)) : "-"});
    lines.rows.push_back({title, line ? significant(line->slope) : "-", line ? intervalText(line->slopeInterval) : "-",
                          line ? significant(line->intercept) : "-",
                          line ? intervalText(line->interceptInterval) : "-"});
    if (!line) refused.emplace_back("Deming's line of " + c.title, line.reason());
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
    report.json["results"].push_back(agreementJson(c, *r, line));
    if (std::optional<Drawing> drawing = differencePlot(c, *r, data.synthetic))
      report.drawings.push_back(std::move(*drawing));
  }
  askForResults(data, report.json["results"].size(), refused);
  report.tables = {std::move(limits), std::move(lines)};
  report.notes.push_back(
      choices.against.empty()
          ? fmt::format("Differences: {} less {}, of participants with both.", data.occasions[0], data.occasions[1])
          : std::string("Differences: the first less the second, of participants with both."));
  report.notes.emplace_back(
      "95 % of differences are expected within the limits; whether these are narrow enough is a question of use, not "
      "of a "
      "test. rho of scatter: Spearman's correlation of the absolute difference with the mean.");
  for (const std::string& warning : warnings) report.notes.push_back(warning);
  noteRefused(report, refused);
  report.methods = fmt::format(
      "Agreement is described by bias and limits of agreement (mean and 1.96 standard deviations of the differences) "
      "with "
      "Student's intervals (Bland and Altman 1999), and by Deming regression with a ratio of error variances of {} and "
      "jackknife intervals (Linnet 1993).",
      significant(choices.errorRatio));
}

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

void analyseCorrelation(const DesignData& data, const DesignChoices& choices, DesignReport& report) {
  const DesignFigure& against = againstOf(data, choices.against);
  ReportTable table =
      tableOf("Correlation with " + against.name, {"=figure", "n", "rho", "95 %", "p", "Holm", "=method of p"});
  std::vector<std::pair<std::string, std::string>> refused;
  std::vector<std::optional<double>> p;
  report.json["against"] = against.name;
  report.json["results"] = DesignJson::array();
  for (const DesignFigure& figure : data.figures) {
    if (&figure == &against) continue;
    const FigurePairs pairs = pairsOf(figure, against);
    const Expected<Spearman> test = spearman(pairs.first, pairs.second);
    if (!test) {
      refused.emplace_back(figure.name, test.reason());
      continue;
    }
    const Expected<Interval> interval = spearmanInterval(test->rho, pairs.first.size());
    const char* method = test->exact ? "all orders" : "Student's t";
    table.rows.push_back({figureTitle(figure), fmt::format("{}", pairs.first.size()), fmt::format("{:+.3f}", test->rho),
                          intervalText(interval), pText(test->p), "", method});
    p.emplace_back(test->p);
    report.json["results"].push_back({{"figure", figure.name},
                                      {"unit", figure.unit},
                                      {"n", pairs.first.size()},
                                      {"rho", test->rho},
                                      {"interval", interval ? intervalJson(*interval) : reasonJson(interval.reason())},
                                      {"p", test->p},
                                      {"method", method}});
  }
  askForResults(data, p.size(), refused);
  const std::vector<std::optional<double>> adjusted = holmOver(p);
  for (std::size_t i = 0; i < p.size(); ++i) {
    table.rows[i][5] = pOrDash(adjusted[i]);
    report.json["results"][i]["p_holm"] = optionalJson(adjusted[i]);
  }
  report.tables.push_back(std::move(table));
  report.notes.push_back(fmt::format(
      "rho: over all participants who have both figures. In a mixture of groups that differ in both it is larger than "
      "within a group. Holm: over {} figures.",
      p.size()));
  noteRefused(report, refused);
  report.methods = fmt::format(
      "Figures were correlated with {} by Spearman's rank correlation with the interval of Bonett and Wright; p values "
      "were adjusted by Holm's method.",
      against.name);
}

}  // namespace calot::analytics
