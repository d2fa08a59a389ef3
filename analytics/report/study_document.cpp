// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <optional>
#include <utility>

#include "analytics/report/plots.h"
#include "analytics/report/study_output.h"
#include "analytics/report/study_tables.h"

namespace calot::analytics {
namespace {

Figures boxPlots(const Study& study) {
  Figures figures;
  for (const StudyRow& row : study.rows) {
    if (auto plot = boxPlotOf(study, row)) figures.drawings.push_back(std::move(*plot));
  }
  return figures;
}

Figures scorePlots(const Study& study) {
  Figures figures;
  for (const FormReport& form : study.ratings) {
    for (Drawing& drawing : drawScores(form, study.synthetic)) figures.drawings.push_back(std::move(drawing));
  }
  return figures;
}

}  // namespace

std::optional<Drawing> boxPlotOf(const Study& study, const StudyRow& row, const PlotFrame& frame) {
  return drawBoxPlot({.title = rowName(row),
                      .axis = row.unit == "1" ? "" : row.unit,
                      .groups = {study.groups[0], study.groups[1]},
                      .values = {row.values[0], row.values[1]},
                      .synthetic = study.synthetic,
                      .point = [&](std::size_t group, std::size_t i) -> BoxPlot::Point {
                        if (i >= row.participants[group].size()) return {};
                        const std::string& who = row.participants[group][i];
                        return {who, fmt::format("{}: {:.6g} {}\n{}", study.groups[group], row.values[group][i],
                                                 row.unit == "1" ? "" : row.unit, who)};
                      },
                      .frame = frame});
}

ReportDocument studyDocument(const Study& study) {
  ReportDocument document{studyTitle(study), study.synthetic, {}};
  for (const std::string& line : studyHead(study)) document.add(line);
  document.parts.emplace_back(flowTable(study));
  document.parts.emplace_back(primaryTable(study));
  document.addList(primaryNotes(study));
  if (std::optional<Drawing> forest = forestOf(study)) document.parts.emplace_back(Figures{{std::move(*forest)}});
  document.add(studyMethods(study));
  document.parts.emplace_back(Heading{"Appendix", true});
  for (ReportTable& table : appendixTables(study)) document.parts.emplace_back(std::move(table));
  document.parts.emplace_back(Heading{"Notes"});
  document.addList(appendixNotes(study));
  if (Figures figures = boxPlots(study); !figures.drawings.empty()) {
    document.parts.emplace_back(Heading{"Figures"});
    document.add(
        "Box: quartiles and median; whiskers: the outermost values within 1.5 times the box's height; a point for each "
        "participant, or for one in so many. A group of fewer than five is shown by its points alone.");
    document.parts.emplace_back(std::move(figures));
  }
  if (Figures figures = scorePlots(study); !figures.drawings.empty()) {
    document.parts.emplace_back(Heading{"Scores"});
    document.add("Of each item and group the share of each score among those given, and in it how often it was given.");
    document.parts.emplace_back(std::move(figures));
  }
  return document;
}

void printStudy(const Study& study, std::ostream& out, StudyDetail detail) {
  const auto print = [&](const std::vector<std::string>& lines) {
    for (const std::string& line : lines) printWrapped(line, out);
  };
  if (study.synthetic) out << watermarkText << '\n';
  printWrapped(studyTitle(study), out);
  print(studyHead(study));
  out << '\n';
  for (const auto& row : flowTable(study).rows) printWrapped(row[0] + " " + study.counted + " " + row[1], out);
  out << '\n';
  printTable(primaryTable(study), out);
  print(primaryNotes(study));
  if (detail == StudyDetail::all) {
    out << '\n';
    for (const ReportTable& table : appendixTables(study)) printTable(table, out);
    print(appendixNotes(study));
    printWrapped(studyMethods(study), out);
  }
  if (study.synthetic) out << watermarkText << '\n';
}

}  // namespace calot::analytics
