// SPDX-License-Identifier: GPL-3.0-or-later
// A study as tables and sentences, the same on the terminal and in a page.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "analytics/report/study.h"
#include "analytics/report/text_table.h"

namespace calot::analytics {

struct ReportTable {
  std::string title;
  std::vector<std::pair<std::string, TextTable::Align>> columns;
  std::vector<std::vector<std::string>> rows;
};

/// What stands over everything that performers' figures are in.
inline constexpr const char* watermarkText = "SYNTHETIC: made by performers, says nothing about people";

std::string studyTitle(const Study& study);  ///< "Study (exploratory): expert against novice"
std::string rowName(const StudyRow& row);    ///< checkpoint and subject

/// How many came in, stayed out and why, and are analysed.
ReportTable flowTable(const Study& study);
/// "Values", "Comparison", "Further": a row without any value is in none of them. Those without rows are left out.
std::vector<ReportTable> studyTables(const Study& study);
/// What the columns mean, the family, remarks and warnings, published figures, missing values: whole sentences.
std::vector<std::string> studyNotes(const Study& study);

}  // namespace calot::analytics
