// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/modules/tables.h"

extern "C" const calot::apps::Module* calotModule() {
  static constexpr calot::apps::PdfModule table{{CALOT_MODULE_BUILD}, calot::gui::pdfReport, calot::gui::sheetsPdf};
  return &table;
}
