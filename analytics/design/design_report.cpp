// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/design/design_report.h"

#include <fmt/format.h>

#include <utility>

#include "analytics/design/design_parts.h"
#include "recorder/attempt.h"

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
    case Design::areas:
      return analyseAreas;
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

}  // namespace calot::analytics
