// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/coverage_warning.h"

#include <fmt/format.h>

namespace calot::analytics {

std::string coverageWarning(CoveredInterval interval, const std::string& name, std::size_t nx, std::size_t ny,
                            const std::string& unit) {
  CoverageDoubt doubt;
  if (!doubtful(interval, nx, ny, doubt)) return {};
  if (!doubt.known) return fmt::format("{}: coverage is not known for fewer than {} {}", name, doubt.size, unit);
  return fmt::format("{}: with {} {} an interval at 95 % covers {} % (population: {})", name, doubt.size, unit,
                     doubt.percent, doubt.population);
}

}  // namespace calot::analytics
