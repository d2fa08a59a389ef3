// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

#include "analytics/statistics/expected.h"
#include "analytics/statistics/interval.h"

namespace calot::analytics {

struct ModelAttempt {
  std::size_t participant = 0;
  bool inX = false;      ///< group; one for all attempts of a participant
  std::size_t site = 0;  ///< stratum; one for all attempts of a participant
  double value = 0.0;
};

struct RandomIntercept {
  double difference = 0.0;  ///< mean of x less mean of y, within sites
  double error = 0.0;
  double t = 0.0, df = 0.0, p = 1.0;  ///< Student, df = participants less sites less 1 (containment); two-sided
  Interval interval;
  double betweenVariance =
      0.0;  ///< of participants; 0: at its bound, attempts of a person are no more alike than others
  double withinVariance = 0.0;           ///< of attempts of one participant
  double restrictedLogLikelihood = 0.0;  ///< without the term ln |X'X| / 2 that depends on the coding (as R's nlme)
};

/// Value = constant + b [x] + site + u_participant + e by restricted maximum likelihood (intercept_model.h). Intervals
/// and p take the variances as known but for the degrees of freedom. Sites are fixed strata. No answer for an empty
/// group, a participant in two groups or sites, fewer participants than the model needs, or as fitInterceptModel().
Expected<RandomIntercept> randomIntercept(std::span<const ModelAttempt> attempts, double level = 0.95);

}  // namespace calot::analytics
