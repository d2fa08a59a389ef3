// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/attempts_to_criterion.h"

#include <cassert>

namespace calot::analytics {

bool meets(double value, double criterion, Better better) {
  return better == Better::lower ? value <= criterion : value >= criterion;
}

CensoredTime attemptsToCriterion(std::span<const double> values, double criterion, Better better, std::size_t run) {
  assert(!values.empty() && run > 0);
  std::size_t met = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    met = meets(values[i], criterion, better) ? met + 1 : 0;
    if (met == run) return {static_cast<double>(i + 1), true};
  }
  return {static_cast<double>(values.size()), false};
}

}  // namespace calot::analytics
