// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/marker_sheet_file.h"

#include "recorder/attempt.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_output.h"
#ifdef CALOT_PDF
#include "gui/report/pdf_report.h"
#endif

namespace calot::apps {

void writeMarkerSheets([[maybe_unused]] const std::string& file, [[maybe_unused]] bool force) {
#ifdef CALOT_PDF
  recorder::refuseOutput(file, force);
  recorder::writeText(file, gui::sheetsPdf(recorder::markerSheets(), recorder::softwareName(), recorder::tagCells),
                      force);
#else
  throw Error(ErrorKind::invalid, "this build writes no PDF");
#endif
}

}  // namespace calot::apps
