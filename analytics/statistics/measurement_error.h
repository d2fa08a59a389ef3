// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

#include "analytics/statistics/expected.h"
#include "analytics/statistics/interval.h"
#include "analytics/statistics/repeated_attempts.h"

namespace calot::analytics {

struct MeasurementError {
  std::size_t people = 0, attempts = 0;  ///< with two attempts or more
  double df = 0.0;                       ///< attempts less people
  double sem = 0.0;                      ///< standard error of measurement: deviation of a person's attempts
  double sdc = 0.0;                      ///< smallest detectable change of one person: 1.96 sqrt(2) SEM
  Interval semInterval, sdcInterval;
};

/// Deviation of attempts about their own participant's mean, pooled over participants with two attempts or more: SEM^2
/// = sum of squares / (attempts - people) (de Vet et al. 2006, J. Clin. Epidemiol. 59:1033; "agreement": a systematic
/// change from attempt to attempt counts as error). Interval from chi-squared, which assumes normal errors of one
/// variance. No answer for values not finite, nobody with two attempts, or attempts of each person all equal.
/// @pre 0 < level < 1.
Expected<MeasurementError> measurementError(std::span<const RepeatedValue> values, double level = 0.95);

}  // namespace calot::analytics
