// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace calot::analytics {

/// analytics/external/run_metric.py: what runs a user's script and writes one line of JSON to file descriptor 3. It
/// travels inside the program.
std::string_view metricRunner();

}  // namespace calot::analytics
