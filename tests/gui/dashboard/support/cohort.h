// SPDX-License-Identifier: GPL-3.0-or-later
// Attempts and values for cohort databases of tests.
#pragma once

#include <string>

#include "analytics/cohort/cohort_database.h"

namespace calot::gui::test {

/// A verified synthetic attempt, skilled where i is even, else unskilled; ordered in time within a month by i.
analytics::AttemptRecord attemptNumber(int i);
analytics::CheckpointValue pathLength(const std::string& hand, double metres);

/// A cohort as a centre has it after years: attempts of 200 people, experts and novices, 40 figures each, all of one
/// comparability key. @pre no such file
void makeLargeCohort(const std::string& path, int attempts);

}  // namespace calot::gui::test
