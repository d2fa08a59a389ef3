// SPDX-License-Identifier: GPL-3.0-or-later
// Many tests at once. Adjusted p values, to be compared with the level, in the order of the input.
#pragma once

#include <span>
#include <vector>

#include "analytics/statistics/expected.h"

namespace calot::analytics {

/// Holm (1979, Scand. J. Stat. 6:65): with p_(1) <= ... <= p_(m), max over j <= i of min(1, (m - j + 1) p_(j)).
/// Controls the familywise error rate under any dependence: for primary questions. No answer for no p values or one
/// outside of [0, 1].
Expected<std::vector<double>> holm(std::span<const double> p);

/// Benjamini and Hochberg (1995, J. R. Stat. Soc. B 57:289): min over j >= i of min(1, m p_(j) / j). Controls the false
/// discovery rate for independent or positively dependent tests: for exploration. Same preconditions as holm().
Expected<std::vector<double>> benjaminiHochberg(std::span<const double> p);

}  // namespace calot::analytics
