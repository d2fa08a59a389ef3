// SPDX-License-Identifier: GPL-3.0-or-later
// The first page of a sheet on one attempt, for whoever grades it: who, which task and when, the verdict, the figures
// that count against their pass marks, pictures of the gravest moments, a box for a comment and one to sign. What else
// there is stands behind it, as an appendix.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "analytics/assessment/grade.h"
#include "analytics/report/report_document.h"

namespace calot::analytics {

/// A moment that is worth a picture.
struct SheetMoment {
  double time = 0.0;    ///< s
  std::string caption;  ///< "1:40.2 critical: cystic duct left open"
};
inline constexpr std::size_t maxSheetMoments = 3;

/// Up to maxSheetMoments, by time and a second apart: of the critical and major errors, the gravest first; then of
/// figures, those that fall short by the grade before those that count before others.
/// @param errors the gravest first @param grade null: the attempt is not held against a norm
std::vector<SheetMoment> worstMoments(const std::vector<ErrorLine>& errors, const std::vector<FigureMoments>& figures,
                                      const Grade* grade);

struct AttemptSheet {
  AttemptRow attempt;
  std::vector<CheckpointValue> values;
  const Grade* grade = nullptr;   ///< null: the attempt is not held against a norm
  std::vector<ErrorLine> errors;  ///< the gravest first
  std::vector<Picture> pictures;  ///< of worstMoments()
  std::string picturesMissing;    ///< the reason for their absence, or empty
  std::string recording = {};     ///< how the sheet names the recording, for links to moments; empty: none
  std::string howToDraw = {};     ///< a sentence on how the program draws a moment of it; may be empty
};

/// The sheet: its first page, then the appendix: gradeAppendix(), or without a grade the errors and every value.
ReportDocument sheetDocument(const AttemptSheet& sheet);

/// "2026-02-03 14:05", by the clock of this place; as it is where it is no time. @param utc ISO 8601 with Z
std::string localTime(const std::string& utc);

}  // namespace calot::analytics
