// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "apps/calot/commands.h"

namespace calot::apps {

/// `calot cohort export` and `bundle`.
void addCohortExports(CLI::App& parent, Run& run);

}  // namespace calot::apps
