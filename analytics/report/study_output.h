// SPDX-License-Identifier: GPL-3.0-or-later
// A study as text, JSON, CSV and a document. Numbers are written with a point, whatever the locale.
#pragma once

#include <cstdint>
#include <ostream>
#include <string>

#include "analytics/report/report_document.h"
#include "analytics/report/study.h"

namespace calot::analytics {

enum class StudyDetail : std::uint8_t {
  first,  ///< heading, flow, the first result and its notes: about one screen
  all     ///< the appendix and the methods as well
};

/// For a terminal of 120 columns.
void printStudy(const Study& study, std::ostream& out, StudyDetail detail = StudyDetail::all);

/// The whole model as one JSON object; missing numbers are null, with a reason.
std::string studyJson(const Study& study);

/// Writes study.csv (a row a checkpoint), values.csv (a row a participant and checkpoint), flow.csv and, where forms
/// were filled in, ratings.csv (a row an item and group) into a folder, which is made; files that are there are kept
/// unless `force`.
/// @throws Error (invalid) when a file is there already, Error (failure) when writing fails.
void writeStudyCsv(const Study& study, const std::string& folder, bool force);

/// First page: heading, flow, the first result with its notes, its forest plot, methods. Appendix: all other tables, a
/// box plot with all points for each row, and of each form that was filled in how its scores are spread.
ReportDocument studyDocument(const Study& study);

}  // namespace calot::analytics
