// SPDX-License-Identifier: GPL-3.0-or-later
// Times of attempts of which some were not finished. An abandoned attempt is never simply fast.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analytics/statistics/expected.h"
#include "analytics/statistics/standard_setting.h"
#include "analytics/statistics/two_groups.h"

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

/// A time at which attempts of a group finished.
struct SurvivalStep {
  double time = 0.0;
  double followed = 0.0, finished = 0.0;  ///< still under way just before, and finished at it
  double unfinished = 1.0;                ///< estimated share not finished after it
};

struct KaplanMeier {
  std::vector<SurvivalStep> steps;       ///< by time
  std::size_t people = 0, finished = 0;  ///< the others are censored
  std::optional<double> median;          ///< none where more than half never finish
  std::optional<double> lower, upper;    ///< of the median; none where the curve's limit stays on one side of one half
  double level = 0.95;
};

/// Product-limit estimate (Kaplan and Meier 1958, J. Am. Stat. Assoc. 53:457) of the share not finished. The median is
/// the first time at which it is at most one half (midway to the next, where it is one half exactly); its interval are
/// the times between which the pointwise limits of ln(-ln S) by Greenwood's variance cross one half (Brookmeyer and
/// Crowley 1982, Biometrics 38:29; as R's survfit(conf.type = "log-log")). No answer for an empty group, a time not
/// positive, or when nobody finished. @pre 0 < level < 1.
Expected<KaplanMeier> kaplanMeier(std::span<const CensoredTime> times, double level = 0.95);

/// At the criterion one meets it.
bool meets(double value, double criterion, Better better);

/// Number of attempts until the criterion was met in `run` attempts one after the other: the last of these; or all
/// attempts, censored. @param values in the order of the attempts @pre values not empty, finite; run > 0.
CensoredTime attemptsToCriterion(std::span<const double> values, double criterion, Better better, std::size_t run = 1);

}  // namespace calot::analytics
