// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/report_files.h"

#include "analytics/report/page_html.h"
#include "gui/report/pdf_report.h"
#include "recorder/attempt.h"
#include "recorder/formats/text_output.h"

namespace calot::apps {

void writeReport(const analytics::ReportDocument& document, const std::string& html, const std::string& pdf,
                 bool force) {
  if (!html.empty()) recorder::writeText(html, analytics::pageHtml(document), force);
  if (!pdf.empty()) recorder::writeText(pdf, gui::pdfReport(document, recorder::softwareName()), force);
}

}  // namespace calot::apps
