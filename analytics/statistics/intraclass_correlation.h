// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "analytics/statistics/expected.h"
#include "analytics/statistics/interval.h"
#include "analytics/statistics/rating_table.h"

namespace calot::analytics {

/// Three of the forms of Shrout and Fleiss (1979, Psychol. Bull. 86:420), by what the design is. 2: the raters are a
/// sample, and their leniency counts as error; 3: these raters alone, leniency apart. Single: reliability of one rater;
/// average: of the mean of all k.
enum class IccForm : std::uint8_t { twoSingle, twoAverage, threeAverage };

/// "ICC(2,1)" and so on.
const char* nameOf(IccForm form);

struct IntraclassCorrelation {
  double value = 0.0;  ///< may be negative
  Expected<Interval> interval = Expected<Interval>::none("not computed");
};

/// With mean squares S (subjects), R (raters), E (residual), n subjects and k raters:
///   ICC(2,1) = (S - E) / (S + (k - 1) E + k (R - E) / n)
///   ICC(2,k) = (S - E) / (S + (R - E) / n)
///   ICC(3,k) = (S - E) / S
/// Intervals from the F distribution, for ICC(2,.) with Satterthwaite's degrees of freedom (Shrout and Fleiss; McGraw
/// and Wong 1996, Psychol. Methods 1:30); that of ICC(2,k) is the single one's by Spearman and Brown. No answer as
/// objection(table), and where the denominator is not positive. No interval where the raters agree but for leniency.
Expected<IntraclassCorrelation> intraclassCorrelation(const RatingTable& table, IccForm form, double level = 0.95);

}  // namespace calot::analytics
