// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>

#include "apps/calot/commands.h"

namespace calot::apps {

/// Adds `calot norm angoff`: how many figures of the rule a borderline trainee passes, by judges.
void addNormAngoff(CLI::App& norm, Run& run);

}  // namespace calot::apps
