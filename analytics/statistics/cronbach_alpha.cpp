// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/cronbach_alpha.h"

#include <cassert>

#include "analytics/statistics/distributions.h"

namespace calot::analytics {

Expected<CronbachAlpha> cronbachAlpha(const RatingTable& items, double level) {
  using Result = Expected<CronbachAlpha>;
  assert(level > 0.0 && level < 1.0);
  if (items.raters < 3) return Result::none("fewer than three items");
  if (const std::string reason = objection(items); !reason.empty()) return Result::none(reason);
  const MeanSquares s = meanSquares(items);
  if (!(s.subjects > 0.0)) return Result::none("the sums of all subjects are equal");
  CronbachAlpha result;
  const double error = s.residual / s.subjects;  // 1 - alpha
  result.value = 1.0 - error;
  if (!(error > 0.0)) {
    result.interval = Expected<Interval>::none("the items agree perfectly");
    return result;
  }
  const double df1 = static_cast<double>(items.subjects) - 1.0, df2 = df1 * (static_cast<double>(items.raters) - 1.0);
  const double tail = (1.0 - level) / 2.0;
  result.interval = Interval{1.0 - error * fisherQuantile(1.0 - tail, df1, df2),
                             1.0 - error * fisherQuantile(tail, df1, df2), level, "Feldt's F"};
  return result;
}

}  // namespace calot::analytics
