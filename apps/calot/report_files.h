// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "analytics/report/report_document.h"

namespace calot::apps {

/// Writes a report as a page and on paper, where a file is named. @throws Error as recorder::writeText and
/// gui::pdfReport
void writeReport(const analytics::ReportDocument& document, const std::string& html, const std::string& pdf,
                 bool force);

}  // namespace calot::apps
