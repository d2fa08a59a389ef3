// SPDX-License-Identifier: GPL-3.0-or-later
// Lists of what a cohort holds: calot attempt list, calot participant list.
#pragma once

#include "apps/calot/command.h"

namespace calot::apps {

/// Adds `list` to `calot attempt`.
void addAttemptList(CLI::App& attempt, Run& run);

/// Adds `list` to `calot participant`.
void addParticipantList(CLI::App& participant, Run& run);

}  // namespace calot::apps
