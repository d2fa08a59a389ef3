// SPDX-License-Identifier: GPL-3.0-or-later
// A report on paper.
// Sheets of markers on paper.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "analytics/report/report_document.h"
#include "recorder/sources/devices/camera/marker_sheets.h"

class QPagedPaintDevice;

namespace calot::gui {

/// Paints the report on pages of a device, a printer or a PDF's writer, within its margins: title and page number at
/// the foot of each, the watermark behind a synthetic report. Only the pages that the device is set to, if it is set to
/// any (QPagedPaintDevice::setPageRanges()). @throws Error (failure) where no font is installed
void paintReport(const analytics::ReportDocument& document, QPagedPaintDevice& device);

/// The report as a PDF file's bytes: A4, title and page number at the foot of each page, heads of tables repeated on
/// each page, figures as vectors, fonts embedded; across every page of a synthetic report its watermark. Needs no
/// display, and leaves the process' locale as it was. The file holds the time at which it was made.
/// @param maker what made it: "calot 0.1.0"
/// May be called in any thread where Qt's application is there already.
/// @throws Error (failure) where no font is installed
std::string pdfReport(const analytics::ReportDocument& document, const std::string& maker);

/// The sheets as a PDF file's bytes, a page each, A4, true to scale.
/// @param cells of a tag with its margin, as recorder::tagCells gives them
/// @throws Error (failure) where no font is installed
std::string sheetsPdf(const std::vector<recorder::MarkerSheet>& sheets, const std::string& maker,
                      const std::function<std::array<bool, 100>(int id)>& cells);

}  // namespace calot::gui
