// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "analytics/statistics/expected.h"
#include "analytics/statistics/interval.h"
#include "analytics/statistics/rating_table.h"

namespace calot::analytics {

struct AngoffCut {
  double cut = 0.0;    ///< expected number of items that a borderline trainee passes
  double error = 0.0;  ///< of the judges' mean
  Interval interval;
};

/// Angoff's pass mark (1971): each judge gives the probability that a borderline trainee passes each item; a judge's
/// mark is the sum over the items, the cut the judges' mean. Interval by Student's t over the judges. No answer for
/// fewer than two judges or one item, values not finite or outside of [0, 1], or judges' sums all equal.
/// @param judged a row a judge, a column an item @pre 0 < level < 1.
Expected<AngoffCut> angoffCut(const RatingTable& judged, double level = 0.95);

}  // namespace calot::analytics
