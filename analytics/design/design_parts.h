// SPDX-License-Identifier: GPL-3.0-or-later
// Common parts of the designs' reports.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "analytics/design/design_report.h"
#include "analytics/statistics/expected.h"

namespace calot::analytics {

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
void analyseAreas(const DesignData& data, const DesignChoices& choices, DesignReport& report);
void analyseCorrelation(const DesignData& data, const DesignChoices& choices, DesignReport& report);
void analyseAgreement(const DesignData& data, const DesignChoices& choices, DesignReport& report);
void analyseReliability(const DesignData& data, const DesignChoices& choices, DesignReport& report);

/// Hypothesis about a figure of two groups from its direction and the better group: whether the first group's values
/// should be larger; none without both.
std::optional<bool> firstShouldBeLarger(const DesignData& data, const DesignFigure& figure);

}  // namespace calot::analytics
