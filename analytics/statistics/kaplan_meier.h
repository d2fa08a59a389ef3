// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "analytics/statistics/censored_times.h"
#include "analytics/statistics/expected.h"

namespace calot::analytics {

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

}  // namespace calot::analytics
