// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analytics/statistics/expected.h"

namespace calot::analytics {

/// y = X b + u_participant + e, u and e independent and normal, fitted by restricted maximum likelihood.
struct InterceptModel {
  std::vector<double> coefficients;      ///< b, a column of X each
  std::vector<double> errors;            ///< of b; the variances taken as known
  double betweenVariance = 0.0;          ///< of u; 0: at its bound
  double withinVariance = 0.0;           ///< of e
  double restrictedLogLikelihood = 0.0;  ///< without the term ln |X'X| / 2 that depends on the coding (as R's nlme)
  std::size_t participants = 0, attempts = 0;
};

/// Restricted maximum likelihood (Patterson and Thompson 1971, Biometrika 58:545). With l = var u / var e and w_i = 1 -
/// 1 / sqrt(1 + n_i l), rows less w_i times their participant's mean are independent of one variance, so the likelihood
/// is maximised over l alone. No answer for lengths that differ, values not finite, no participant with two attempts,
/// attempts of each participant all equal, columns that depend on each other, fewer attempts than columns, or a
/// likelihood without a clear maximum.
/// @param participants whose attempt each row is @param columns of X, each as long as y
Expected<InterceptModel> fitInterceptModel(const std::vector<std::vector<double>>& columns,
                                           std::span<const std::size_t> participants, std::span<const double> y);

}  // namespace calot::analytics
