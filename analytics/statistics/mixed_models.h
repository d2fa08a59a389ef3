// SPDX-License-Identifier: GPL-3.0-or-later
// Repeated attempts: the random-intercept model, and each participant's change over occasions.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/regression.h"

namespace calot::analytics {

struct ModelVariances {
  double betweenVariance = 0.0;  ///< of participants; 0: at its bound, attempts of a person are as alike as others
  double withinVariance = 0.0;   ///< of attempts of one participant
  double restrictedLogLikelihood = 0.0;  ///< without the term ln |X'X| / 2 that depends on the coding (as R's nlme)
  std::size_t participants = 0, attempts = 0;
};

/// y = X b + u_participant + e, u and e independent and normal, fitted by restricted maximum likelihood.
struct InterceptModel : ModelVariances {
  std::vector<double> coefficients;  ///< b, a column of X each
  std::vector<double> errors;        ///< of b; the variances taken as known
};

/// Restricted maximum likelihood (Patterson and Thompson 1971, Biometrika 58:545). With l = var u / var e and w_i = 1 -
/// 1 / sqrt(1 + n_i l), rows less w_i times their participant's mean are independent of one variance, so the likelihood
/// is maximised over l alone. No answer for lengths that differ, values not finite, no participant with two attempts,
/// attempts of each participant all equal, columns that depend on each other, fewer attempts than columns, or a
/// likelihood without a clear maximum.
/// @param participants whose attempt each row is @param columns of X, each as long as y
Expected<InterceptModel> fitInterceptModel(const std::vector<std::vector<double>>& columns,
                                           std::span<const std::size_t> participants, std::span<const double> y);

struct ModelAttempt {
  std::size_t participant = 0;
  bool inX = false;      ///< group; one for all attempts of a participant
  std::size_t site = 0;  ///< stratum; one for all attempts of a participant
  double value = 0.0;
};

/// Mean of x less mean of y, within sites; df = participants less sites less 1 (containment).
struct RandomIntercept : ModelTerm, ModelVariances {};

/// Value = constant + b [x] + site + u_participant + e by restricted maximum likelihood (fitInterceptModel()).
/// Intervals and p take the variances as known but for the degrees of freedom. Sites are fixed strata. No answer for an
/// empty group, a participant in two groups or sites, fewer participants than the model needs, or as
/// fitInterceptModel().
Expected<RandomIntercept> randomIntercept(std::span<const ModelAttempt> attempts, double level = 0.95);

struct OccasionValue {
  std::size_t participant = 0;
  double occasion = 0.0; /**< number of the attempt, or the place of a named occasion: 0, 1, ... */
  double value = 0.0;
};

enum class OccasionKind {
  number,  ///< one slope over the occasion
  named    ///< each occasion against the first
};

/// How each participant changes, by ascending participant; those of whom it cannot be known are left out. Their changes
/// are independent whatever the attempts of one person have in common, also where people learn at different speeds.
/// number: the least-squares slope over the occasion. named: for each later occasion the difference from the first one
/// (means, where there are several values at one). As many lists as there are changes; none for a value not finite.
std::vector<std::vector<ParticipantValue>> personalChanges(std::span<const OccasionValue> values, OccasionKind kind);

}  // namespace calot::analytics
