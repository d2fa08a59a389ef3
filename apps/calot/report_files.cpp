// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/report_files.h"

#include "recorder/attempt.h"
#include "recorder/base/text_output.h"
#ifdef CALOT_PDF
#include "gui/report/pdf_report.h"
#endif

namespace calot::apps {

void addPdfOption(CLI::App& command, std::string& file, const std::string& help) {
  [[maybe_unused]] CLI::Option* option = command.add_option("--pdf", file, help);
#ifndef CALOT_PDF
  option->check([](const std::string&) { return "this build writes no PDF; --html writes the same report"; });
#endif
}

void writeReport(const analytics::ReportDocument& document, const std::string& html,
                 [[maybe_unused]] const std::string& pdf, bool force, const analytics::CarriedRecording* recording) {
  if (!html.empty()) recorder::writeText(html, analytics::pageHtml(document, recording), force);
#ifdef CALOT_PDF
  if (!pdf.empty()) recorder::writeText(pdf, gui::pdfReport(document, recorder::softwareName()), force);
#endif
}

}  // namespace calot::apps
