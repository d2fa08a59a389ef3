// SPDX-License-Identifier: GPL-3.0-or-later
// A report on paper.
// A short report with pictures on one page.
// Sheets of markers on paper.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "analytics/report/report_document.h"
#include "gui/render/image.h"
#include "recorder/sources/devices/camera/marker_sheets.h"

namespace calot::gui {

/// The report as a PDF file's bytes: A4, title and page number at the foot of each page, heads of tables repeated on
/// each page, figures as vectors, fonts embedded; across every page of a synthetic report its watermark. Needs no
/// display, and leaves the process' locale as it was. The file holds the time at which it was made.
/// @param maker what made it: "calot 0.1.0"
/// May be called in any thread where Qt's application is there already.
/// @throws Error (failure) where no font is installed
std::string pdfReport(const analytics::ReportDocument& document, const std::string& maker);

/// A picture and the line beneath it.
struct CaptionedPicture {
  Image image;
  std::string caption;
};

/// As pdfReport(), on a single A4 page: pictures side by side at its foot, the report above them, made smaller where it
/// would not fit. @param pictures up to three; none: the report alone
/// @throws Error (failure) where no font is installed
std::string onePagePdf(const analytics::ReportDocument& document, const std::vector<CaptionedPicture>& pictures,
                       const std::string& maker);

/// The sheets as a PDF file's bytes, a page each, A4, true to scale.
/// @param cells of a tag with its margin, as recorder::tagCells gives them
/// @throws Error (failure) where no font is installed
std::string sheetsPdf(const std::vector<recorder::MarkerSheet>& sheets, const std::string& maker,
                      const std::function<std::array<bool, 100>(int id)>& cells);

}  // namespace calot::gui
