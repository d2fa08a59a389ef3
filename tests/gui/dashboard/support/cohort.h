// SPDX-License-Identifier: GPL-3.0-or-later
// Attempts and values for cohort databases of tests.
#pragma once

#include <string>

#include "analytics/cohort/cohort_database.h"

namespace calot::gui::test {

/// A verified synthetic attempt, skilled where i is even, else unskilled; ordered in time within a month by i.
analytics::AttemptRecord attemptNumber(int i);
analytics::CheckpointValue pathLength(const std::string& hand, double metres);

}  // namespace calot::gui::test
