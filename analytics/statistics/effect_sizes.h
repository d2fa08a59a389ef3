// SPDX-License-Identifier: GPL-3.0-or-later
// Hedges' g, and the interval of A = P(X > Y) (the area under the ROC curve, Cliff's delta).
#pragma once

#include <cstdint>
#include <span>

#include "analytics/statistics/expected.h"
#include "analytics/statistics/two_groups.h"

namespace calot::analytics {

struct HedgesG {
  double g = 0.0;  ///< J d
  double d = 0.0;  ///< Cohen's: (mx - my) / s, s^2 the pooled variance with nx + ny - 2
  double j = 1.0;  ///< small-sample correction
  /// "J times non-central t": the non-centralities at which t = d sqrt(nx ny / (nx + ny)) is the upper and the lower
  /// quantile, converted back to d, times J. Assumes normal groups of one variance.
  Expected<Interval> interval = Expected<Interval>::none("not computed");
};

/// Hedges' g (Hedges 1981, J. Educ. Stat. 6:107): J = Gamma(m / 2) / (sqrt(m / 2) Gamma((m - 1) / 2)), m = nx + ny - 2.
/// No answer for fewer than two values in a group or when there is no spread within both. @pre 0 < level < 1.
Expected<HedgesG> hedgesG(std::span<const double> x, std::span<const double> y, double level = 0.95);

/// Hypothesis stated before the data were seen. An area below one half speaks against the hypothesis and stays below.
enum class Hypothesis : std::uint8_t { firstLarger, firstSmaller };

struct SuperiorityEstimate {
  Superiority value;  ///< in the direction of the hypothesis
  Interval a;
  Interval delta;  ///< the same, times 2 less 1
};

/// A of the hypothesis: P(X > Y) + P(X = Y) / 2 for firstLarger, P(X < Y) + P(X = Y) / 2 for firstSmaller. Its score
/// interval: solutions A' of |A - A'| = z s(A'), s^2 = A' (1 - A') (1 + n* ((1 - A') / (2 - A') + A' / (1 + A'))) /
/// (nx ny), n* = (nx + ny) / 2 - 1 (Newcombe 2006, Stat. Med. 25:559, method 5), which exist at A = 0 and A = 1, too.
/// No answer for an empty group or when all values are equal. @pre 0 < level < 1.
Expected<SuperiorityEstimate> estimateSuperiority(std::span<const double> x, std::span<const double> y,
                                                  Hypothesis hypothesis, double level = 0.95);

}  // namespace calot::analytics
