// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/measurement_error.h"

#include <cmath>
#include <map>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"

namespace calot::analytics {

Expected<MeasurementError> measurementError(std::span<const RepeatedValue> values, double level) {
  using Result = Expected<MeasurementError>;
  std::map<std::size_t, std::vector<double>> of;
  for (const RepeatedValue& v : values) {
    if (!std::isfinite(v.value)) return Result::none("a value is not finite");
    of[v.participant].push_back(v.value);
  }
  MeasurementError result;
  double squares = 0.0;
  for (const auto& item : of) {
    if (item.second.size() < 2) continue;
    ++result.people;
    result.attempts += item.second.size();
    const double middle = *mean(item.second);
    for (const double v : item.second) squares += (v - middle) * (v - middle);
  }
  if (result.people == 0) return Result::none("nobody has two attempts");
  if (!(squares > 0.0)) return Result::none("attempts of each participant are all equal");
  result.df = static_cast<double>(result.attempts - result.people);
  result.sem = std::sqrt(squares / result.df);
  const double factor = normalQuantile(0.975) * std::sqrt(2.0);
  result.sdc = factor * result.sem;
  const double lower = std::sqrt(squares / chiSquaredQuantile(0.5 + level / 2.0, result.df));
  const double upper = std::sqrt(squares / chiSquaredQuantile(0.5 - level / 2.0, result.df));
  result.semInterval = {lower, upper, level, "chi-squared"};
  result.sdcInterval = {factor * lower, factor * upper, level, "chi-squared"};
  return result;
}

}  // namespace calot::analytics
