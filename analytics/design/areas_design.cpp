// SPDX-License-Identifier: GPL-3.0-or-later
// Which of several figures separates two groups better.
#include <fmt/format.h>

#include <map>

#include "analytics/design/design_report.h"
#include "analytics/statistics/delong.h"
#include "recorder/base/errors.h"

namespace calot::analytics {
namespace {

/// One value of a person for each of two figures, by group; larger is expected in the better group.
struct BothFigures {
  std::vector<double> firstX, secondX, firstY, secondY;
};

BothFigures pairedValues(const DesignData& data, const DesignFigure& first, const DesignFigure& second) {
  const OneEach a = oneEachOf(first), b = oneEachOf(second);
  const double signA = first.direction == Direction::lower ? -1.0 : 1.0;
  const double signB = second.direction == Direction::lower ? -1.0 : 1.0;
  std::map<std::size_t, double> other;
  for (std::size_t i = 0; i < b.person.size(); ++i) other[b.person[i]] = b.value[i];
  BothFigures both;
  for (std::size_t i = 0; i < a.person.size(); ++i) {
    const auto at = other.find(a.person[i]);
    if (at == other.end()) continue;
    const bool better = data.groups[data.people[a.person[i]].group] == data.better;
    (better ? both.firstX : both.firstY).push_back(signA * a.value[i]);
    (better ? both.secondX : both.secondY).push_back(signB * at->second);
  }
  return both;
}

}  // namespace

void analyseAreas(const DesignData& data, const DesignChoices&, DesignReport& report) {
  constexpr std::size_t most = 12;
  if (data.figures.size() < 2 || data.figures.size() > most)
    throw Error(
        ErrorKind::refused, Where{data.where},
        fmt::format("areas of {} figures can't be compared in pairs: 2 to {} are wanted", data.figures.size(), most),
        {Remedy::nameFamily});
  if (data.better.empty())
    throw Error(ErrorKind::refused, Where{data.where}, "areas need the group that is expected to do better",
                {Remedy::nameBetterGroup});
  for (const DesignFigure& f : data.figures) {
    if (f.direction == Direction::none)
      throw Error(ErrorKind::refused, Where{data.where},
                  fmt::format("which values of {} are better, lower or higher, is not known", f.name));
  }
  ReportTable table = tableOf("Areas under the ROC curve", {"=first", "=second", "n", "A first", "A second",
                                                            "difference", "95 %", "z", "p", "Holm", "=method"});
  std::vector<std::pair<std::string, std::string>> refused;
  std::vector<std::optional<double>> p;
  report.json["results"] = DesignJson::array();
  for (std::size_t i = 0; i < data.figures.size(); ++i) {
    for (std::size_t j = i + 1; j < data.figures.size(); ++j) {
      const BothFigures both = pairedValues(data, data.figures[i], data.figures[j]);
      const Expected<PairedAreas> areas = compareAreas({both.firstX, both.secondX, both.firstY, both.secondY});
      const std::string &first = data.figures[i].name, &second = data.figures[j].name;
      if (!areas) {
        refused.emplace_back(first + " and " + second, areas.reason());
        continue;
      }
      const std::size_t n = both.firstX.size() + both.firstY.size();
      table.rows.push_back({first, second, fmt::format("{}", n), fmt::format("{:.3f}", areas->first),
                            fmt::format("{:.3f}", areas->second), fmt::format("{:+.3f}", areas->difference),
                            areas->interval ? intervalText(*areas->interval) : "-",
                            areas->z ? fmt::format("{:+.2f}", *areas->z) : "-", pText(areas->p), "", areas->method});
      p.emplace_back(areas->p);
      report.json["results"].push_back(
          {{"first", first},
           {"second", second},
           {"n", n},
           {"area_first", areas->first},
           {"area_second", areas->second},
           {"difference", areas->difference},
           {"interval", areas->interval ? intervalJson(*areas->interval) : DesignJson(nullptr)},
           {"z", optionalJson(areas->z)},
           {"p", areas->p},
           {"method", areas->method}});
    }
  }
  askForResults(data, p.size(), refused);
  const std::vector<std::optional<double>> adjusted = holmOver(p);
  for (std::size_t i = 0; i < p.size(); ++i) {
    table.rows[i][9] = pOrDash(adjusted[i]);
    report.json["results"][i]["p_holm"] = optionalJson(adjusted[i]);
  }
  report.tables.push_back(std::move(table));
  report.notes.push_back(
      fmt::format("A: chance that a participant of {} has the better value, ties counting one half; of those who have "
                  "both figures. Holm: over {} pairs.",
                  data.better, p.size()));
  noteRefused(report, refused);
  report.methods =
      "Areas under the ROC curves of the same participants were compared by DeLong's method, or by permutation where "
      "the "
      "table says so; p values were adjusted by Holm's method.";
}

}  // namespace calot::analytics
