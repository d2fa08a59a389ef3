// SPDX-License-Identifier: GPL-3.0-or-later
// A report on paper.
#pragma once

#include <string>

#include "analytics/report/report_document.h"

namespace calot::gui {

/// The report as a PDF file's bytes: A4, title and page number at the foot of each page, heads of tables repeated on
/// each page, figures as vectors, fonts embedded; across every page of a synthetic report its watermark. Needs no
/// display, and leaves the process' locale as it was. The file holds the time at which it was made.
/// @param maker what made it: "calot 0.1.0"
/// May be called in any thread where Qt's application is there already.
/// @throws Error (failure) where no font is installed
std::string pdfReport(const analytics::ReportDocument& document, const std::string& maker);

}  // namespace calot::gui
