// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gui/dashboard/import_queue.h"

namespace calot::apps {

/// `calot assess`, for the dashboard.
gui::AssessProgram assessProgram();

}  // namespace calot::apps
