// SPDX-License-Identifier: GPL-3.0-or-later
// Figures against another, such as a rating: concurrent validity.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "analytics/design/design_parts.h"
#include "analytics/design/paired_figures.h"
#include "analytics/statistics/spearman.h"
#include "recorder/base/errors.h"

namespace calot::analytics {

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
