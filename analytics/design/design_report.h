// SPDX-License-Identifier: GPL-3.0-or-later
// Results of a design as tables, sentences, figures and JSON: the same on the terminal, in a page and on paper; and
// what the designs share in making them.
#pragma once

#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "analytics/design/design_data.h"
#include "analytics/report/plots.h"
#include "analytics/report/value_tree.h"
#include "analytics/statistics/expected.h"

namespace calot::analytics {

struct DesignReport {
  std::string title;
  bool synthetic = false;
  std::vector<std::string> head;
  ReportTable flow;
  std::vector<ReportTable> tables;
  std::vector<std::string> notes;                            ///< whole sentences
  std::vector<std::pair<std::string, std::string>> refused;  ///< what could not be analysed, and why
  std::vector<Drawing> drawings;
  std::string methods;                ///< what was done, without population and software
  ValueTree json;                     ///< everything with all digits; missing numbers are null with a reason
  std::vector<std::string> attempts;  ///< uuids of a cohort's attempts that are in it
};

/// The design's analysis of the data.
/// @throws Error (refused) where no figure can be analysed or a figure does not fit the design, with the reason.
DesignReport makeDesignReport(const DesignData& data, const DesignChoices& choices);

ReportDocument designDocument(const DesignReport& report);
void printDesign(const DesignReport& report, std::ostream& out);

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

/// Results of `analyse` for each figure, beside the figure's name and unit: "results". Others are refused.
/// @param except a figure that is left out @throws Error (refused) naming the first reason, where nothing was analysed.
ValueTree& analyseFigures(const DesignData& data, DesignReport& report,
                          const std::function<Expected<ValueTree>(const DesignFigure&)>& analyse,
                          const DesignFigure* except = nullptr);
/// The same where `analysed` results are there already.
void askForResults(const DesignData& data, const DesignReport& report, std::size_t analysed);

/// Adds "p_holm" beside each "p" of the rows. @param place of the object that holds it, "/log_rank", or the row itself
void addHolm(ValueTree& rows, const std::string& place = "");

/// "name [unit]" of a result.
std::string figureTitle(const ValueTree& result);
/// "12 [9, -]", "not reached", or the reason for its absence, of {"median", "lower", "upper"} or {"reason"}.
std::string medianText(const ValueTree& times);

// The designs: tables, notes, methods, figures and "results" in JSON.
void analyseSeveralGroups(const DesignData& data, const DesignChoices& choices, DesignReport& report);
void analyseStrata(const DesignData& data, const DesignChoices& choices, DesignReport& report);
void analyseRepeated(const DesignData& data, const DesignChoices& choices, DesignReport& report);
void analyseTimes(const DesignData& data, const DesignChoices& choices, DesignReport& report);
void analyseLearning(const DesignData& data, const DesignChoices& choices, DesignReport& report);
void analyseCorrelation(const DesignData& data, const DesignChoices& choices, DesignReport& report);
void analyseAgreement(const DesignData& data, const DesignChoices& choices, DesignReport& report);
void analyseReliability(const DesignData& data, const DesignChoices& choices, DesignReport& report);

}  // namespace calot::analytics
