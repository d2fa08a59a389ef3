// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "tests/bench/growth_exponent.h"

namespace calot::bench {

/// The value below which a share `q` of the values lies (nearest rank). @pre values is not empty
double quantile(std::vector<double> values, double q);

}  // namespace calot::bench
