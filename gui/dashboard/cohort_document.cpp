// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/cohort_document.h"

namespace calot::gui {

CohortDocument::CohortDocument(const std::string& path)
    : database_(path, analytics::CohortDatabase::Access::read), attempts_(database_.listAttempts()) {}

}  // namespace calot::gui
