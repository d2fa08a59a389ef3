// SPDX-License-Identifier: GPL-3.0-or-later
// Attempts and their values as tables for a terminal.
#pragma once

#include <ostream>
#include <vector>

#include "analytics/cohort/cohort_database.h"

namespace calot::gui {

/// Every value of one attempt, in display units, or the reason why there is none; with intervals, two columns more: the
/// interval, and what it is made of.
void printValues(const std::vector<analytics::CheckpointValue>& values,
                 const std::vector<analytics::ValueInterval>& intervals, std::ostream& out);

/// Closing table of `calot assess`: every attempt of the database with outcome, verification and the checkpoints that
/// ask for columns there (CheckpointPlace::summaryTitle), without those that no attempt has; synthetic ones are marked.
void printAttempts(const analytics::CohortDatabase& database, std::ostream& out);

}  // namespace calot::gui
