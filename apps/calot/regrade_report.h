// SPDX-License-Identifier: GPL-3.0-or-later
// What `calot regrade` prints, whether it ran here or in shares.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "analytics/regrade.h"
#include "apps/common/exit_code.h"

namespace calot::apps {

nlohmann::ordered_json regradeJson(const analytics::Regrade& regrade);
/// Each changed value, then how many attempts each checkpoint changed in, then a line of counts.
void printRegrade(const analytics::Regrade& regrade);
/// One line on stderr for each attempt that something stands in the way of. @returns their exit code
ExitCode reportFaults(const std::string& cohort, const analytics::Regrade& regrade);

}  // namespace calot::apps
