// SPDX-License-Identifier: GPL-3.0-or-later
// A short report with pictures on one page.
#pragma once

#include <string>
#include <vector>

#include "analytics/report/report_document.h"
#include "gui/render/image.h"

namespace calot::gui {

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

}  // namespace calot::gui
