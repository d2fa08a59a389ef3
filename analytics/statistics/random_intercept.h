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

/// Value = constant + b [x] + site + u_participant + e, u and e independent and normal, by restricted maximum
/// likelihood (Patterson and Thompson 1971, Biometrika 58:545). With l = var u / var e and w_i = 1 - 1 / sqrt(1 + n_i
/// l), values less w_i times their participant's mean are independent of one variance, so the likelihood is maximised
/// over l alone. Intervals and p take the variances as known but for the degrees of freedom. Sites are fixed strata. No
/// answer for an empty group, a participant in two groups or sites, values not finite, no participant with two attempts
/// (take the first or the mean), attempts of each participant all equal, fewer participants than the model needs, or a
/// likelihood without a clear maximum.
Expected<RandomIntercept> randomIntercept(std::span<const ModelAttempt> attempts, double level = 0.95);

}  // namespace calot::analytics
