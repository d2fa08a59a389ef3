// SPDX-License-Identifier: GPL-3.0-or-later
// A grade as text, as one tree of values, and as the appendix of a sheet.
#pragma once

#include <ostream>
#include <string>

#include "analytics/assessment/grade.h"
#include "analytics/report/report_document.h"
#include "analytics/report/value_tree.h"

namespace calot::analytics {

void printGrade(const Grade& grade, std::ostream& out);
ValueTree gradeTree(const Grade& grade);
/// The appendix behind a sheet's first page: use and rule of the norm, figures, moments, history, notes.
/// @param recording how the sheet names the recording, for links to its moments ("a.h5#t=12,13", a media fragment);
/// empty: none
/// @param howToDraw a sentence on how the program draws a moment of it; may be empty
void addGradeAppendix(ReportDocument& document, const Grade& grade, const std::string& recording,
                      const std::string& howToDraw);

}  // namespace calot::analytics
