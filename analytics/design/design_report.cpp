// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/design/design_report.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "analytics/report/report_text.h"
#include "analytics/statistics/rank_tests.h"
#include "recorder/attempt.h"
#include "recorder/base/errors.h"

namespace calot::analytics {
namespace {

using Analyse = void (*)(const DesignData&, const DesignChoices&, DesignReport&);

Analyse analysisOf(Design design) {
  switch (design) {
    case Design::severalGroups:
      return analyseSeveralGroups;
    case Design::strata:
      return analyseStrata;
    case Design::repeated:
      return analyseRepeated;
    case Design::timeToCriterion:
      return analyseTimes;
    case Design::learning:
      return analyseLearning;
    case Design::correlation:
      return analyseCorrelation;
    case Design::agreement:
      return analyseAgreement;
    case Design::reliability:
      return analyseReliability;
    case Design::twoGroups:
      break;  // makeStudy() does it
  }
  return nullptr;
}

/// "expert (8 participants), novice (9)", or how many participants there are.
std::string populationOf(const DesignData& data) {
  if (data.groups.empty()) return fmt::format("{} participants", data.people.size());
  std::string text;
  for (std::size_t g = 0; g < data.groups.size(); ++g) {
    std::size_t count = 0;
    for (const DesignPerson& p : data.people) count += p.group == g ? 1 : 0;
    text += fmt::format("{}{} {}", g == 0 ? "" : ", ", count, data.groups[g]);
  }
  return text;
}

ReportTable flowOfDesign(const DesignData& data) {
  ReportTable table = tableOf("Flow", {data.counted, "="});
  table.rows.push_back({fmt::format("{}", data.recruited), "in the " + data.source});
  for (const FlowRow& row : data.flow)
    table.rows.push_back({fmt::format("{}", row.attempts), "left out: " + row.reason});
  table.rows.push_back(
      {fmt::format("{}", data.analysed), fmt::format("analysed: {}; {}", populationOf(data), data.attemptRule)});
  return table;
}

}  // namespace

DesignReport makeDesignReport(const DesignData& data, const DesignChoices& choices) {
  const DesignEntry& entry = entryOf(choices.design);
  DesignReport report;
  report.title = fmt::format("Study (exploratory), {}: {}?", entry.name, entry.question);
  report.synthetic = data.synthetic;
  report.head = data.head;
  report.flow = flowOfDesign(data);
  report.attempts = data.attempts;
  std::vector<std::string> groups = data.groups;
  report.json = {
      {"design", entry.name},
      {"heading", "exploratory"},
      {"source", data.source},
      {"synthetic", data.synthetic},
      {"groups", groups},
      {"better", data.better},
      {"participants", data.people.size()},
      {"attempt_rule", data.attemptRule},
      {"flow", {{"recruited", data.recruited}, {"analysed", data.analysed}, {"left_out", DesignJson::array()}}}};
  for (const FlowRow& row : data.flow)
    report.json["flow"]["left_out"].push_back({{"reason", row.reason}, {"count", row.attempts}});
  analysisOf(choices.design)(data, choices, report);
  for (const std::string& remark : data.remarks) report.notes.push_back(remark);
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
  if (report.synthetic) out << watermarkText << '\n';
  printWrapped(report.title, out);
  for (const std::string& line : report.head) printWrapped(line, out);
  out << '\n';
  for (const auto& row : report.flow.rows)
    printWrapped(fmt::format("{} {} {}", row[0], report.flow.columns[0].first, row[1]), out);
  out << '\n';
  for (const ReportTable& table : report.tables) printTable(table, out);
  for (const std::string& note : report.notes) printWrapped(note, out);
  printWrapped(report.methods, out);
  if (report.synthetic) out << watermarkText << '\n';
}

std::string designJson(const DesignReport& report) {
  return report.json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

namespace {

constexpr std::array<Ink, 3> lineInks{Ink::firstLine, Ink::secondLine, Ink::thirdLine};
constexpr std::array<Ink, 3> pointInks{Ink::firstPoint, Ink::secondPoint, Ink::firstPoint};
constexpr std::size_t maxLegend = 18;  // in letters
constexpr double legendHeight = 13.0;

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
    legend += legendHeight;
  }
  endPlot(drawing, plot.synthetic);
  return drawing;
}

std::string intervalText(double lower, double upper) {
  return fmt::format("[{}, {}]", significant(lower), significant(upper));
}
std::string intervalText(const Interval& interval) { return intervalText(interval.lower, interval.upper); }
std::string intervalText(const Expected<Interval>& interval) { return interval ? intervalText(*interval) : "-"; }

DesignJson intervalJson(const Interval& interval) {
  return {{"lower", interval.lower}, {"upper", interval.upper}, {"level", interval.level}, {"method", interval.method}};
}
DesignJson optionalJson(const std::optional<double>& value) { return value ? DesignJson(*value) : DesignJson(nullptr); }
DesignJson reasonJson(const std::string& reason) { return {{"value", nullptr}, {"reason", reason}}; }

ReportTable tableOf(const std::string& title, const std::vector<std::string>& columns) {
  ReportTable table{title, {}, {}};
  for (const std::string& column : columns) {
    const bool left = column.empty() || column[0] == '=';
    table.columns.emplace_back(left && !column.empty() ? column.substr(1) : column,
                               left ? TextTable::Align::left : TextTable::Align::right);
  }
  return table;
}

std::vector<std::optional<double>> holmOver(const std::vector<std::optional<double>>& p) {
  std::vector<double> known;
  for (const auto& value : p) {
    if (value) known.push_back(*value);
  }
  std::vector<std::optional<double>> adjusted(p.size());
  const Expected<std::vector<double>> values = holm(known);
  if (!values) return adjusted;
  std::size_t next = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (p[i]) adjusted[i] = (*values)[next++];
  }
  return adjusted;
}

std::string figureTitle(const DesignFigure& figure) {
  return figure.unit.empty() ? figure.name : fmt::format("{} [{}]", figure.name, figure.unit);
}

void noteRefused(DesignReport& report, const std::vector<std::pair<std::string, std::string>>& refused) {
  constexpr std::size_t most = 10;
  for (std::size_t i = 0; i < refused.size() && i < most; ++i)
    report.notes.push_back(fmt::format("Not analysed: {}: {}.", refused[i].first, refused[i].second));
  if (refused.size() > most) report.notes.push_back(fmt::format("Nor {} more figures.", refused.size() - most));
}

void askForResults(const DesignData& data, std::size_t analysed,
                   const std::vector<std::pair<std::string, std::string>>& refused) {
  if (analysed > 0) return;
  throw Error(ErrorKind::refused, Where{data.where},
              refused.empty() ? std::string("there is no figure to analyse")
                              : fmt::format("no figure can be analysed; {}: {}", refused[0].first, refused[0].second));
}

std::optional<bool> firstShouldBeLarger(const DesignData& data, const DesignFigure& figure) {
  if (figure.direction == Direction::none || data.better.empty()) return std::nullopt;
  return (figure.direction == Direction::higher) == (data.better == data.groups[0]);
}

}  // namespace calot::analytics
