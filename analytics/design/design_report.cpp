// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/design/design_report.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "analytics/report/study_people.h"
#include "analytics/report/terminal_text.h"
#include "analytics/statistics/rank_tests.h"
#include "recorder/base/counted.h"
#include "recorder/base/errors.h"
#include "recorder/loop.h"

namespace calot::analytics {
namespace {

using Analyse = void (*)(const DesignData&, const DesignChoices&, DesignReport&);

/// In Design's order; makeStudy() compares two groups.
constexpr std::array<Analyse, 9> analyses{nullptr,           analyseSeveralGroups, analyseStrata,      analyseRepeated,
                                          analyseTimes,      analyseLearning,      analyseCorrelation, analyseAgreement,
                                          analyseReliability};

/// "expert (8 participants), novice (9)", or how many participants there are.
std::string populationOf(const DesignData& data) {
  if (data.groups.empty()) return recorder::counted(data.people.size(), "participant");
  std::string text;
  for (std::size_t g = 0; g < data.groups.size(); ++g) {
    std::size_t count = 0;
    for (const DesignPerson& p : data.people) count += p.group == g ? 1 : 0;
    text += fmt::format("{}{} {}", g == 0 ? "" : ", ", count, data.groups[g]);
  }
  return text;
}

/// At most ten with their reasons, then their number.
void noteRefused(DesignReport& report) {
  constexpr std::size_t most = 10;
  const auto& refused = report.refused;
  for (std::size_t i = 0; i < refused.size() && i < most; ++i)
    report.notes.push_back(fmt::format("Not analysed: {}: {}.", refused[i].first, refused[i].second));
  if (refused.size() > most) report.notes.push_back(fmt::format("Nor {} more figures.", refused.size() - most));
}

}  // namespace

DesignReport makeDesignReport(const DesignData& data, const DesignChoices& choices) {
  const DesignEntry& entry = entryOf(choices.design);
  DesignReport report;
  report.title = fmt::format("Study (exploratory), {}: {}?", entry.name, entry.question);
  report.synthetic = data.synthetic;
  report.head = data.head;
  report.flow = flowTable(data, data.groups);
  report.attempts = data.attempts;
  report.json = {
      {"design", entry.name},
      {"heading", "exploratory"},
      {"source", data.source},
      {"synthetic", data.synthetic},
      {"groups", data.groups},
      {"better", data.better},
      {"participants", data.people.size()},
      {"attempt_rule", data.attemptRule},
      {"flow", {{"recruited", data.recruited}, {"analysed", data.analysed}, {"left_out", ValueTree::array()}}}};
  for (const FlowRow& row : data.flow)
    report.json["flow"]["left_out"].push_back({{"reason", row.reason}, {"count", row.attempts}});
  analyses[static_cast<std::size_t>(choices.design)](data, choices, report);
  noteRefused(report);
  report.notes.emplace_back("Intervals hold for each figure by itself, not for all at once (not simultaneous).");
  report.notes.insert(report.notes.end(), data.remarks.begin(), data.remarks.end());
  report.methods =
      fmt::format("Methods. {}Of {} {} in the {}, {} of {} were analysed ({}); {} were left out. {} Computed by {}.",
                  data.synthetic ? "Attempts were made by performers, which are programs. " : "", data.recruited,
                  data.counted, data.source, data.analysed, populationOf(data), data.attemptRule,
                  data.recruited - data.analysed, report.methods, recorder::softwareName());
  report.json["methods"] = report.methods;
  report.json["notes"] = report.notes;
  return report;
}

ReportDocument designDocument(const DesignReport& report) {
  ReportDocument document{report.title, report.synthetic, {}};
  for (const std::string& line : report.head) document.add(line);
  document.parts.emplace_back(report.flow);
  for (const ReportTable& table : report.tables) document.parts.emplace_back(table);
  if (!report.notes.empty()) document.addList(report.notes);
  document.add(report.methods);
  if (!report.drawings.empty()) document.parts.emplace_back(Figures{report.drawings});
  return document;
}

void printDesign(const DesignReport& report, std::ostream& out) {
  printReport({report.title, report.synthetic, report.head, report.flow}, out, [&] {
    for (const ReportTable& table : report.tables) printTable(table, out);
    for (const std::string& note : report.notes) printWrapped(note, out);
    printWrapped(report.methods, out);
  });
}

namespace {

constexpr std::array<Ink, 3> lineInks{Ink::firstLine, Ink::secondLine, Ink::thirdLine};
constexpr std::array<Ink, 3> pointInks{Ink::firstPoint, Ink::secondPoint, Ink::firstPoint};
constexpr std::size_t maxLegend = 18;  // in letters
constexpr double legendLine = 13.0;

}  // namespace

std::optional<Drawing> drawLines(const LinePlot& plot) {
  std::vector<double> x, y(plot.marks);
  for (const PlotSeries& s : plot.series) {
    for (const auto& [px, py] : s.points) {
      x.push_back(px);
      y.push_back(py);
    }
  }
  const std::optional<PlotScale> across = plotScale(x, plot.frame), scale = plotScale(y, plot.frame);
  if (x.empty() || !across || !scale) return std::nullopt;
  const PlotFrame& frame = plot.frame;
  const auto at = [&](double value) { return across->x(value); };
  Drawing drawing = beginPlot(plot.title, plot.axis, *scale);
  // Attempts are counted: no tick between two.
  const bool whole = std::all_of(x.begin(), x.end(), [](double v) { return v == std::floor(v); });
  for (const double tick : roundTicks(across->low, across->high)) {
    if (whole && tick != std::floor(tick)) continue;
    drawing.text(Ink::count, at(tick), frame.bottom() + 14.0, fmt::format("{:.6g}", tick == 0.0 ? 0.0 : tick));
  }
  drawing.text(Ink::group, (frame.left() + frame.right()) / 2.0, frame.bottom() + 32.0, plot.below);
  for (const double mark : plot.marks)
    drawing.line(Ink::cut, frame.left(), scale->y(mark), frame.right(), scale->y(mark));
  double legend = frame.top() + 8.0;
  for (const PlotSeries& s : plot.series) {
    const std::size_t ink = s.ink < 2 ? s.ink : 2;
    for (std::size_t i = 0; i < s.points.size(); ++i) {
      const auto& [px, py] = s.points[i];
      if (!s.joined) drawing.point(pointInks[ink], at(px), scale->y(py), 2.6);
      if (!s.joined || i == 0) continue;
      const double before = scale->y(s.points[i - 1].second);
      if (s.stepped) {
        drawing.line(lineInks[ink], at(s.points[i - 1].first), before, at(px), before);
        drawing.line(lineInks[ink], at(px), before, at(px), scale->y(py));
      } else {
        drawing.line(lineInks[ink], at(s.points[i - 1].first), before, at(px), scale->y(py));
      }
    }
    if (s.label.empty()) continue;
    drawing.line(lineInks[ink], frame.right() - 110.0, legend - 4.0, frame.right() - 96.0, legend - 4.0);
    drawing.text(Ink::label, frame.right() - 92.0, legend, cutTo(s.label, maxLegend));
    legend += legendLine;
  }
  endPlot(drawing, plot.synthetic);
  return drawing;
}

ValueTree& analyseFigures(const DesignData& data, DesignReport& report,
                          const std::function<Expected<ValueTree>(const DesignFigure&)>& analyse,
                          const DesignFigure* except) {
  ValueTree& results = report.json["results"] = ValueTree::array();
  for (const DesignFigure& figure : data.figures) {
    if (&figure == except) continue;
    if (const Expected<ValueTree> result = analyse(figure)) {
      results.push_back({{"figure", figure.name}, {"unit", figure.unit}});
      results.back().update(*result);
    } else {
      report.refused.emplace_back(figure.name, result.reason());
    }
  }
  askForResults(data, report, results.size());
  return results;
}

void askForResults(const DesignData& data, const DesignReport& report, std::size_t analysed) {
  if (analysed > 0) return;
  throw Error(ErrorKind::refused, Where{data.where},
              report.refused.empty() ? std::string("there is no figure to analyse")
                                     : fmt::format("no figure can be analysed; {}: {}", report.refused[0].first,
                                                   report.refused[0].second));
}

void addHolm(ValueTree& rows, const std::string& place) {
  const ValueTree::json_pointer at(place);
  std::vector<double> p;
  for (const ValueTree& row : rows) p.push_back(row.at(at).at("p").get<double>());
  const Expected<std::vector<double>> adjusted = holm(p);
  for (std::size_t i = 0; i < rows.size(); ++i)
    rows[i].at(at)["p_holm"] = adjusted ? ValueTree((*adjusted)[i]) : ValueTree(nullptr);
}

std::string figureTitle(const ValueTree& result) {
  const std::string name = result.at("figure"), unit = result.at("unit");
  return unit.empty() ? name : fmt::format("{} [{}]", name, unit);
}

std::string medianText(const ValueTree& times) {
  if (times.contains("reason")) return times["reason"];
  if (times.at("median").is_null()) return "not reached";
  return fmt::format("{} [{}, {}]", digits4(times["median"]), digits4(times["lower"]), digits4(times["upper"]));
}

}  // namespace calot::analytics
