// SPDX-License-Identifier: GPL-3.0-or-later
// A study as printed: two pages, then its appendix.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "analytics/report/plots.h"
#include "analytics/report/ratings.h"
#include "analytics/report/study_output.h"
#include "analytics/report/study_people.h"

namespace calot::analytics {
namespace {

constexpr std::size_t maxReasons = 5, maxTraits = 6, maxLeading = 12, maxForest = 10, maxBoxes = 4;  // of the two pages
constexpr std::size_t maxCell = 60, maxParagraph = 320, maxLegend = 640, maxMethods = 1000;          // in letters
constexpr double boxHeight = 170.0;  // of a plot of the second page, in the drawing's units

/// Height that is left of a printed page, in millimetres, by what its parts are set in (gui/report/text_document.cpp).
class PageSpace {
 public:
  void takeHeading() { left_ -= 11.0; }
  void takeText(const std::string& text) { left_ -= heightOf(text) + 2.0; }
  void takeDrawings(double units, double lines = 1.0) { left_ -= lines * units * 84.0 / plotWidth + 2.0; }
  [[nodiscard]] static double heightOf(const std::string& text) {
    constexpr double lineHeight = 3.6, lettersOfLine = 104.0;
    return lineHeight * std::ceil(static_cast<double>(columnsOf(text)) / lettersOfLine);
  }
  [[nodiscard]] double left() const { return left_; }

 private:
  double left_ = 254.0;
};

/// Leaves the first rows, and cuts their words. @return how many rows are left out
std::size_t shorten(ReportTable& table, std::size_t most) {
  const std::size_t beyond = table.rows.size() - std::min(table.rows.size(), most);
  table.rows.resize(table.rows.size() - beyond);
  for (auto& column : table.columns) column.first = cutTo(column.first, maxCell / 2);
  for (auto& row : table.rows) {
    for (std::string& cell : row) cell = cutTo(cell, maxCell);
  }
  return beyond;
}

/// The flow with its commonest reasons alone; the others are added up in one row.
AnalysedData withFewReasons(const AnalysedData& data) {
  AnalysedData few = data;
  if (few.flow.size() <= maxReasons) return few;
  std::vector<std::uint64_t> counts;
  for (const FlowRow& row : data.flow) counts.push_back(row.attempts);
  std::sort(counts.rbegin(), counts.rend());
  few.flow.clear();
  FlowRow others{"other reasons", 0};
  for (const FlowRow& row : data.flow) {
    if (few.flow.size() + 1 < maxReasons && row.attempts >= counts[maxReasons - 2]) {
      few.flow.push_back(row);
      continue;
    }
    others.attempts += row.attempts;
    for (const auto& [group, people] : row.people) others.people[group] += people;
  }
  few.flow.push_back(std::move(others));
  return few;
}

std::string questionOf(const Study& study) {
  if (study.protocol && !study.protocol->question.empty()) return study.protocol->question;
  const std::string &a = study.groups[0], &b = study.groups[1];
  if (study.better.empty()) return fmt::format("Do {} and {} differ?", a, b);
  return fmt::format("Does {} do better than {}?", study.better, study.better == a ? b : a);
}

/// Question, how it was registered, what was compared: a paragraph each.
std::vector<std::string> shortHead(const Study& study) {
  const std::vector<std::string> head = studyHead(study);
  std::vector<std::string> lines{questionOf(study), registrationText(study)};
  if (study.source != "table" && !study.keys.empty()) {
    lines.push_back(head[head.size() - 2 - study.keys.size()]);
    if (study.keys.size() > 1) lines.back() += fmt::format(" And {} other keys.", study.keys.size() - 1);
  }
  lines.push_back(head[head.size() - 2] + " " + head.back());
  for (std::string& line : lines) line = cutTo(line, maxParagraph);
  return lines;
}

/// States how far the simulation decides, which a p does not know; empty for data without one.
std::string simulationText(const Study& study) {
  std::size_t leading = 0, known = 0, decided = 0;
  for (const StudyRow& row : study.rows) {
    if (!row.leading || hasNoValue(row)) continue;
    ++leading;
    known += row.simulation && row.simulation->area ? 1 : 0;
    decided += row.simulation && row.simulation->decided() ? 1 : 0;
  }
  if (study.source == "table" || leading == 0) return {};
  if (known == 0) return "Uncertainty of the simulation (its step, mesh and constants) was not worked out.";
  return fmt::format(
      "Uncertainty of the simulation was worked out for {} of {} figures; step, mesh and constants do not change which "
      "group is ahead in {} of them.",
      known, leading, decided);
}

/// Notes that the second page has space for, and how many there are beside them.
void addLimits(ReportDocument& document, const Study& study, std::vector<std::string> missing, double space) {
  std::vector<std::string> notes;
  if (study.synthetic)
    notes.emplace_back("Performers, which are programs, made these attempts: no statement on people.");
  if (std::string text = simulationText(study); !text.empty()) notes.push_back(std::move(text));
  const std::vector<std::string> all = primaryNotes(study);
  notes.insert(notes.end(), all.begin() + 1, all.end());  // the legend stands below its table
  std::vector<std::string> shown;
  space -= 2.0 * PageSpace::heightOf(" ");
  for (const std::string& note : notes) {
    const std::string text = cutTo(note, maxParagraph);
    const double height = PageSpace::heightOf(text + "    ") + 0.8;
    if (height > space) break;
    space -= height;
    shown.push_back(text);
  }
  if (shown.size() < notes.size()) missing.push_back(fmt::format("{} notes", notes.size() - shown.size()));
  std::string words;
  for (const std::string& what : missing) words += (words.empty() ? "" : ", ") + what;
  if (!words.empty()) shown.push_back("In the report's appendix alone: " + words + ".");
  if (shown.empty()) return;
  document.parts.emplace_back(Heading{"Limits"});
  document.addList(shown);
}

Figures leadingBoxes(const Study& study, std::size_t most) {
  Figures figures;
  for (const StudyRow& row : study.rows) {
    if (figures.drawings.size() == most) break;
    if (!row.leading) continue;
    if (auto plot = boxPlotOf(study, row, {.height = boxHeight})) figures.drawings.push_back(std::move(*plot));
  }
  return figures;
}

/// The first page. @return what of it the appendix has alone
std::vector<std::string> addFirstPage(ReportDocument& document, const Study& study) {
  std::vector<std::string> missing;
  const auto count = [&](std::size_t beyond, const char* what) {
    if (beyond > 0) missing.push_back(fmt::format("{} {}", beyond, what));
  };
  for (const std::string& line : shortHead(study)) document.add(line);
  ReportTable flow = flowTable(withFewReasons(study), study.groups), people = peopleTable(study),
              result = primaryTable(study);
  (void)shorten(flow, maxReasons + 2);
  count(shorten(people, maxTraits), "characteristics of participants");
  count(shorten(result, maxLeading), "figures of the first result");
  if (study.flow.size() > maxReasons) count(study.flow.size() - maxReasons + 1, "reasons for exclusion");
  for (ReportTable* table : {&flow, &people, &result}) {
    if (!table->rows.empty()) document.parts.emplace_back(std::move(*table));
  }
  document.add(cutTo(primaryNotes(study).front(), maxLegend));
  return missing;
}

void addSecondPage(ReportDocument& document, const Study& study, std::vector<std::string> missing) {
  constexpr double forNotes = 40.0;  // mm
  PageSpace space;
  document.parts.emplace_back(Heading{"Effects and values", true});
  space.takeHeading();
  const std::string methods = cutTo(studyMethods(study), maxMethods);
  space.takeText(methods);
  space.takeHeading();  // of the limits
  if (study.synthetic) space.takeText("the mark at the document's end");
  if (Figures forests{forestsOf(study, maxForest)}; !forests.drawings.empty()) {
    for (const Drawing& forest : forests.drawings) space.takeDrawings(forest.height);
    document.parts.emplace_back(std::move(forests));
  }
  const double lines = std::floor((space.left() - forNotes) / (boxHeight * 84.0 / plotWidth + 2.0));
  const auto most = static_cast<std::size_t>(std::clamp(2.0 * lines, 0.0, static_cast<double>(maxBoxes)));
  if (Figures boxes = leadingBoxes(study, most); !boxes.drawings.empty()) {
    space.takeDrawings(boxHeight, std::ceil(static_cast<double>(boxes.drawings.size()) / 2.0));
    document.parts.emplace_back(std::move(boxes));
  }
  document.add(methods);
  addLimits(document, study, std::move(missing), space.left());
}

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

void addAppendix(ReportDocument& document, const Study& study) {
  document.parts.emplace_back(Heading{"Appendix", true});
  for (const std::string& line : studyHead(study)) document.add(line);
  document.add(studyMethods(study));
  for (ReportTable table : {flowTable(study, study.groups), peopleTable(study), primaryTable(study)}) {
    if (!table.rows.empty()) document.parts.emplace_back(std::move(table));
  }
  document.addList(primaryNotes(study));
  for (ReportTable& table : appendixTables(study)) document.parts.emplace_back(std::move(table));
  document.parts.emplace_back(Heading{"Notes"});
  document.addList(appendixNotes(study));
  if (Figures figures = boxPlots(study); !figures.drawings.empty()) {
    document.parts.emplace_back(Heading{"Figures"});
    document.add(
        "Box: quartiles and median; whiskers: the outermost values within 1.5 times the box's height; a point for each "
        "participant, or for every n-th. A group of fewer than five is shown by its points alone.");
    document.parts.emplace_back(std::move(figures));
  }
  if (Figures figures = scorePlots(study); !figures.drawings.empty()) {
    document.parts.emplace_back(Heading{"Scores"});
    document.add("Of each item and group the share of each score among those given, and in it how often it was given.");
    document.parts.emplace_back(std::move(figures));
  }
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

ReportDocument studyDocument(const Study& study, StudyDetail detail) {
  ReportDocument document{cutTo(studyTitle(study), maxCell * 2), study.synthetic, {}};
  std::vector<std::string> missing = addFirstPage(document, study);
  addSecondPage(document, study, std::move(missing));
  if (detail == StudyDetail::all) addAppendix(document, study);
  return document;
}

}  // namespace calot::analytics
