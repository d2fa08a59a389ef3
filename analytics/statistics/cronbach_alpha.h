// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "analytics/statistics/expected.h"
#include "analytics/statistics/interval.h"
#include "analytics/statistics/rating_table.h"

namespace calot::analytics {

struct CronbachAlpha {
  double value = 0.0;
  Expected<Interval> interval = Expected<Interval>::none("not computed");
};

/// Internal consistency of a scale of k items (columns): k / (k - 1) (1 - sum of the items' variances / variance of the
/// sum) (Cronbach 1951, Psychometrika 16:297); equal to ICC(3,k). Interval: 1 - (1 - alpha) F at the quantiles of F
/// with n - 1 and (n - 1)(k - 1) degrees of freedom (Feldt 1965, Psychometrika 30:357). One subscale at a time: the
/// caller's duty. No answer for fewer than three items, as objection(table), and when the sums of all subjects are
/// equal; no interval where the items agree perfectly.
Expected<CronbachAlpha> cronbachAlpha(const RatingTable& items, double level = 0.95);

}  // namespace calot::analytics
