// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

#include "analytics/statistics/censored_times.h"
#include "analytics/statistics/contrasting_groups.h"

namespace calot::analytics {

/// At the criterion one meets it.
bool meets(double value, double criterion, Better better);

/// Number of attempts until the criterion was met in `run` attempts one after the other: the last of these; or all
/// attempts, censored. @param values in the order of the attempts @pre values not empty, finite; run > 0.
CensoredTime attemptsToCriterion(std::span<const double> values, double criterion, Better better, std::size_t run = 1);

}  // namespace calot::analytics
