// SPDX-License-Identifier: GPL-3.0-or-later
// A, the area under the ROC curve and Cliff's delta: one statistic, one interval.
#pragma once

#include <cstdint>
#include <span>

#include "analytics/statistics/expected.h"
#include "analytics/statistics/interval.h"
#include "analytics/statistics/two_groups.h"

namespace calot::analytics {

/// What was expected before the data were seen. An area below one half speaks against the hypothesis and stays below.
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
