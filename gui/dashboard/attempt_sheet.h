// SPDX-License-Identifier: GPL-3.0-or-later
// Sheets of one attempt, for paper. Knows no window.
#pragma once

#include <filesystem>
#include <QString>
#include <string>
#include <vector>

#include "analytics/assessment/grade.h"
#include "analytics/report/report_document.h"
#include "gui/attempt/attempt_recording.h"
#include "gui/attempt/long_work.h"
#include "gui/render/image.h"

namespace calot::gui {

/// A moment that is worth a picture.
struct WorstMoment {
  double time = 0.0;  ///< s
  std::string caption;
};
inline constexpr std::size_t maxWorstMoments = 3;

struct SheetRequest {
  std::string database;
  analytics::AttemptRow attempt;
  analytics::AttemptSummary summary;
  std::vector<TrackEvent> events;
  std::vector<WorstMoment> moments;  ///< at most maxWorstMoments
  std::filesystem::path recording;   ///< empty: no pictures
  std::string norm;                  ///< name of the norm that the grade sheet is of
  std::uint32_t normVersion = 0;
  std::filesystem::path file;  ///< to be written; one that is there is replaced
};

/// The attempt on one page: verdict, critical view, errors, key figures, what went wrong and when.
[[nodiscard]] analytics::ReportDocument attemptDocument(const SheetRequest& request);
/// Pictures of the scene at these moments. @throws Error, LongWork::Broken
[[nodiscard]] std::vector<Image> picturesAt(const std::filesystem::path& recording, const std::string& attempt,
                                            const std::vector<WorstMoment>& moments, LongWork::Control& control);
/// Work for LongWork: one page with pictures, as PDF.
QString writeOnePage(const SheetRequest& request, LongWork::Control& control);
/// The attempt against the norm, as `calot grade --pdf` writes it.
QString writeGradeSheet(const SheetRequest& request, LongWork::Control& control);

}  // namespace calot::gui
