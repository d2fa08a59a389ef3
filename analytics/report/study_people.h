// SPDX-License-Identifier: GPL-3.0-or-later
// The people of a study: their flow from the register to the analysis, who they are by group ("Table 1" of a paper),
// and what of it may explain a difference as well as the group does.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "analytics/report/report_document.h"
#include "analytics/report/study.h"
#include "analytics/report/study_population.h"

namespace calot::analytics {

/// Counts people by group: in the cohort, at each reason of `data.flow` and analysed. Of several attempts that are left
/// out, the reason that is checked last counts. Registered people without an attempt become a reason of their own.
/// @param analysed attempts of each unit of analysis
void countPeople(AnalysedData& data, const std::vector<AttemptRow>& recruited, const IncludedAttempts& included,
                 const StudyOptions& options, const AttemptsOfUnits& analysed);

/// People by group, and attempts or rows: in the source, left out with reasons, analysed. @param groups that have a
/// column
ReportTable flowTable(const AnalysedData& data, std::span<const std::string> groups);

/// Adds experience, site, arm, device and station of an analysed participant (StudyPerson::traits).
void addTraits(StudyPerson& person, const std::vector<const AttemptRow*>& attempts, const StudyOptions& options);

/// Number of people, their attempts and their traits by group: median [quartiles] of numbers, else how many of each
/// value. Devices and stations only where there are several. No rows where nothing is known of anybody.
ReportTable peopleTable(const Study& study);

/// Site, device or station confounded with group or unequally spread, and unequal numbers of attempts in a mean.
std::vector<std::string> peopleWarnings(const Study& study);

}  // namespace calot::analytics
