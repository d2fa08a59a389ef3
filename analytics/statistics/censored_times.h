// SPDX-License-Identifier: GPL-3.0-or-later
// Times of attempts of which some were not finished. An abandoned attempt is never simply fast.
#pragma once

#include <span>
#include <string>

#include "analytics/statistics/expected.h"
#include "analytics/statistics/superiority_interval.h"

namespace calot::analytics {

struct CensoredTime {
  double time = 0.0;     ///< to the end, or until when the attempt was followed (s, > 0)
  bool finished = true;  ///< false: ended without reaching the goal
};

struct LogRank {
  double observed = 0.0;  ///< finished in x
  double expected = 0.0;  ///< in x, if both groups finished at one rate
  double variance = 0.0;
  double z = 0.0;  ///< (observed - expected) / sqrt(variance); positive: x finishes sooner
  double p = 1.0;  ///< two-sided, normal: an approximation
};

/// Log-rank test (Mantel 1966, Cancer Chemother. Rep. 50:163). At each time at which d of n still followed finish, with
/// m of the n in x: expected d m / n, variance d (m / n) (1 - m / n) (n - d) / (n - 1). An attempt given up at the very
/// time counts as still followed. Right where giving up says nothing about how long it would have taken (a time limit,
/// a technical failure); not for those who gave up because they were slow. No answer for an empty group, a time that is
/// not positive, nobody finished, or when nobody of the other group was left whenever someone finished.
Expected<LogRank> logRank(std::span<const CensoredTime> x, std::span<const CensoredTime> y);

struct WorstRank {
  MannWhitney test;
  SuperiorityEstimate effect;
};

/// Rank sum test with every unfinished attempt ranked behind every finished one, all tied (Lachin 1999, Control. Clin.
/// Trials 20:408). Right where not to finish is the worst result. Hypothesis is about the times: firstSmaller says that
/// x is the faster group. No answer for an empty group, a time that is not positive, or when all are tied.
Expected<WorstRank> worstRank(std::span<const CensoredTime> x, std::span<const CensoredTime> y, Hypothesis hypothesis,
                              double level = 0.95);

}  // namespace calot::analytics
