// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "analytics/cohort/cohort_database.h"

namespace calot::apps {

/// Where a station's key is registered in the cohort, its recordings are signed by it; empty: nothing to say.
std::string keyFaultOf(const analytics::AttemptRecord& attempt, const std::string& cohort);

}  // namespace calot::apps
