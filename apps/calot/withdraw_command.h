// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "apps/calot/commands.h"

namespace calot::apps {

/// `calot participant withdraw`.
void addWithdraw(CLI::App& participant, Run& run);

}  // namespace calot::apps
