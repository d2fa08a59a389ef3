// SPDX-License-Identifier: GPL-3.0-or-later
// Results of a design as tables, sentences, figures and JSON: the same on the terminal, in a page and on paper; and
// what the designs share in making them.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "analytics/design/design_data.h"
#include "analytics/report/plots.h"
#include "analytics/report/report_document.h"
#include "analytics/statistics/expected.h"

namespace calot::analytics {

struct DesignReport {
  std::string title;
  bool synthetic = false;
  std::vector<std::string> head;
  ReportTable flow;
  std::vector<ReportTable> tables;
  std::vector<std::string> notes;  ///< whole sentences
  std::vector<Drawing> drawings;
  std::string methods;                ///< what was done, without population and software
  nlohmann::ordered_json json;        ///< "results" of designJson()
  std::vector<std::string> attempts;  ///< uuids of a cohort's attempts that are in it
};

/// The design's analysis of the data.
/// @throws Error (refused) where no figure can be analysed or a figure does not fit the design, with the reason.
DesignReport makeDesignReport(const DesignData& data, const DesignChoices& choices);

ReportDocument designDocument(const DesignReport& report);
void printDesign(const DesignReport& report, std::ostream& out);
/// Everything with all digits; missing numbers are null with a reason.
std::string designJson(const DesignReport& report);

/// One line, or points, of a plot.
struct PlotSeries {
  std::string label;                              ///< in the legend, or empty
  std::size_t ink = 0;                            ///< 0, 1, and 2 for all others
  std::vector<std::pair<double, double>> points;  ///< x, y
  bool joined = true;                             ///< a line; else points alone
  bool stepped = false;                           ///< a line that keeps its y until the next x
};

struct LinePlot {
  std::string title, axis, below;  ///< axis: the unit of y, or empty; below: what x is
  std::vector<PlotSeries> series;
  std::vector<double> marks;  ///< of y, drawn as dashed lines
  bool synthetic = false;
  PlotFrame frame = {};
};

/// Values over another quantity. None where there are no points, or they are too large or too close for a scale.
std::optional<Drawing> drawLines(const LinePlot& plot);

using DesignJson = nlohmann::ordered_json;

/// "[1.2, 3.4]".
std::string intervalText(double lower, double upper);
std::string intervalText(const Interval& interval);
/// The same, or "-".
std::string intervalText(const Expected<Interval>& interval);

DesignJson intervalJson(const Interval& interval);
DesignJson optionalJson(const std::optional<double>& value);
/// {"reason": ...}
DesignJson reasonJson(const std::string& reason);

/// Table of a title and its columns: text to the left, numbers to the right ("=" before a title: to the left).
ReportTable tableOf(const std::string& title, const std::vector<std::string>& columns);

/// Holm's p over those that there are, in their places.
std::vector<std::optional<double>> holmOver(const std::vector<std::optional<double>>& p);

/// "name [unit]".
std::string figureTitle(const DesignFigure& figure);

/// Figures that could not be analysed, with their reasons, as notes: at most ten, then their number.
void noteRefused(DesignReport& report, const std::vector<std::pair<std::string, std::string>>& refused);
/// @throws Error (refused) naming the first reason, where nothing was analysed.
void askForResults(const DesignData& data, std::size_t analysed,
                   const std::vector<std::pair<std::string, std::string>>& refused);

// The designs: tables, notes, methods, figures and "results" in JSON.
void analyseSeveralGroups(const DesignData& data, const DesignChoices& choices, DesignReport& report);
void analyseStrata(const DesignData& data, const DesignChoices& choices, DesignReport& report);
void analyseRepeated(const DesignData& data, const DesignChoices& choices, DesignReport& report);
void analyseTimes(const DesignData& data, const DesignChoices& choices, DesignReport& report);
void analyseLearning(const DesignData& data, const DesignChoices& choices, DesignReport& report);
void analyseCorrelation(const DesignData& data, const DesignChoices& choices, DesignReport& report);
void analyseAgreement(const DesignData& data, const DesignChoices& choices, DesignReport& report);
void analyseReliability(const DesignData& data, const DesignChoices& choices, DesignReport& report);

/// Hypothesis about a figure of two groups from its direction and the better group: whether the first group's values
/// should be larger; none without both.
std::optional<bool> firstShouldBeLarger(const DesignData& data, const DesignFigure& figure);

}  // namespace calot::analytics
