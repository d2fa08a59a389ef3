// SPDX-License-Identifier: GPL-3.0-or-later
// The report of `calot regrade` and of `calot cohort merge --newer`.
#pragma once

#include <string>

#include "analytics/regrade.h"
#include "apps/common/program.h"

namespace calot::apps {

/// On stdout each changed value, how many attempts each checkpoint changed in, and a line of counts; or JSON, as
/// `command` prints it. On stderr one line for each attempt with a fault. @returns the faults' exit code
ExitCode reportRegrade(const std::string& cohort, const analytics::Regrade& regrade, const char* command, bool json);

}  // namespace calot::apps
