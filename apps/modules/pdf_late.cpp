// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/modules/tables.h"

namespace calot::gui {

std::string pdfReport(const analytics::ReportDocument& document, const std::string& maker) {
  return apps::module<apps::PdfModule>().report(document, maker);
}

std::string sheetsPdf(const std::vector<recorder::MarkerSheet>& sheets, const std::string& maker,
                      const std::function<std::array<bool, 100>(int id)>& cells) {
  return apps::module<apps::PdfModule>().sheets(sheets, maker, cells);
}

}  // namespace calot::gui
