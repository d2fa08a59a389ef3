// SPDX-License-Identifier: GPL-3.0-or-later
// A study as tables and sentences, the same on the terminal and in a page.
#pragma once

#include <string>
#include <vector>

#include "analytics/report/report_document.h"
#include "analytics/report/study.h"

namespace calot::analytics {

std::string studyTitle(const Study& study);  ///< "Study (exploratory): expert against novice"
std::string rowName(const StudyRow& row);    ///< checkpoint and subject
bool hasNoValue(const StudyRow& row);        ///< nobody of either group has one
/// Under the title: the protocol, when it was registered, why the study is exploratory all the same; or empty.
std::vector<std::string> protocolLines(const Study& study);
/// Methods paragraph for a paper: states only what was done.
std::string studyMethods(const Study& study);

/// Flow: numbers included, excluded with reasons, and analysed.
ReportTable flowTable(const Study& study);
/// "Hypotheses" (with a protocol), "Values", "Comparison", "Coverage", "Further": a row without any value is in none of
/// them. Those without rows are left out.
std::vector<ReportTable> studyTables(const Study& study);
/// What the columns mean, the family, remarks and warnings, published figures, missing values: whole sentences.
std::vector<std::string> studyNotes(const Study& study);

}  // namespace calot::analytics
