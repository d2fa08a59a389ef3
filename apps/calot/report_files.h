// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "analytics/report/report_document.h"

namespace calot::apps {

/// Adds `--pdf FILE`. A build without Qt (CALOT_WINDOWS off) has no PDF and refuses the option.
void addPdfOption(CLI::App& command, std::string& file, const std::string& help);

/// Writes a report as a page and on paper, where a file is named. @param recording that the page carries, or null
/// @throws Error as recorder::writeText and gui::pdfReport
void writeReport(const analytics::ReportDocument& document, const std::string& html, const std::string& pdf, bool force,
                 const analytics::CarriedRecording* recording = nullptr);

}  // namespace calot::apps
