// SPDX-License-Identifier: GPL-3.0-or-later
// Pass marks: contrasting groups (Livingston and Zieky 1982), borderline regression, Angoff.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "analytics/statistics/expected.h"
#include "analytics/statistics/reliability.h"
#include "analytics/statistics/resampling.h"

namespace calot::analytics {

/// Direction of better values: declared by the checkpoint, never derived from the data.
enum class Better : std::uint8_t { lower, higher };

struct NormalCurve {
  double mean = 0.0, deviation = 1.0;
};

/// Intersection of the two densities between their means: the root there of
///   ln(s2 / s1) + (x - m2)^2 / (2 s2^2) - (x - m1)^2 / (2 s1^2) = 0.
/// Between the means the left side is monotone, so there is one root or none: no answer where one curve lies above the
/// other all the way, for equal means, or for a deviation that is not positive.
Expected<double> crossing(const NormalCurve& first, const NormalCurve& second);

struct ContrastingGroupsOptions : BootstrapOptions {
  bool logScale = false;  ///< curves of the logarithms (times); the cut is transformed back
};

struct ContrastingGroups {
  double cut = 0.0;  ///< in the unit of the values; at the cut one passes
  /// Percentile bootstrap with groups resampled separately; wide for ten values per group.
  Expected<Interval> interval = NoResult{"not computed"};
  std::uint64_t seed = 0;
};

/// The cut where the normal curves of the two groups cross between their means. No answer for fewer than two values in
/// a group, a group without spread, curves that do not cross there, experts whose mean is not the better one, or values
/// that are not positive on the log scale. @pre as bootstrap().
Expected<ContrastingGroups> contrastingGroups(std::span<const double> experts, std::span<const double> novices,
                                              Better better, const ContrastingGroupsOptions& options = {});

struct BorderlineRegression {
  std::size_t rated = 0;
  double cut = 0.0;  ///< score of an attempt rated at the borderline mark, by the line
  Interval interval;
  double intercept = 0.0, slope = 0.0;
  double r = 0.0;                 ///< correlation of rating and score
  std::size_t atOrBelowMark = 0;  ///< attempts rated at the mark or worse
};

/// Pass mark from global ratings (borderline regression: Kramer et al. 2003, Med. Educ. 37:132): score = a + b rating
/// by least squares, cut = a + b mark. Interval of the line's mean there: cut -+ t s sqrt(1 / n + (mark - mean)^2 /
/// Sxx), n - 2 degrees of freedom. Higher ratings are better. No answer for lengths that differ, fewer than four
/// attempts, values not finite, ratings all equal or on one side of the mark, or a line that rises where it should
/// fall.
/// @pre 0 < level < 1.
Expected<BorderlineRegression> borderlineRegression(std::span<const double> ratings, std::span<const double> scores,
                                                    double mark, Better better, double level = 0.95);

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
