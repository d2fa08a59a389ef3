// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>

#include "analytics/statistics/published_coverage.h"

namespace calot::analytics {

/// Warning about an interval whose published coverage is low at these sizes: "g: with 40 a group an interval at 95 %
/// covers 92.4 % (population: exponential, 0.8)"; empty where it isn't.
/// @param name as the report calls the interval. @param unit of the sizes: "a group", "attempts", "people".
std::string coverageWarning(CoveredInterval interval, const std::string& name, std::size_t nx, std::size_t ny,
                            const std::string& unit = "a group");

}  // namespace calot::analytics
