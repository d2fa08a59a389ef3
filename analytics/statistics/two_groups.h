// SPDX-License-Identifier: GPL-3.0-or-later
// Two independent groups x and y: rank test, effect size, shift. All from one statistic, U = #{x > y} + #{x = y} / 2
// (R's W); and Hedges' g. One value per participant: the caller's duty.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "analytics/statistics/expected.h"

namespace calot::analytics {

enum class RankTest { automatic, exact, asymptotic };

/// Pooled sizes up to which `automatic` counts the exact distribution (some ten milliseconds at the limit).
inline constexpr std::size_t exactRankTestLimit = 80;
/// Pooled sizes up to which the interval of the shift is exact: its distribution is that without ties, which is counted
/// once for each pair of sizes.
inline constexpr std::size_t exactShiftLimit = 300;

struct MannWhitney {
  double u = 0.0;        ///< of x
  double p = 1.0;        ///< two-sided
  double greater = 1.0;  ///< one-sided: P(U >= u)
  /// Smallest p of all assignments of these values to groups of these sizes: no difference between the groups could
  /// have given less.
  double smallestP = 1.0;
  bool exact = false;  ///< permutation distribution of the mid-rank sum, ties included; else normal approximation
  bool ties = false;
};

/// Mann-Whitney U, two-sided (Mann and Whitney 1947). Exact: P(|R - E R| >= |r - E R|) over all assignments of the
/// pooled mid-ranks (with no ties this is the classical exact test). Asymptotic: normal with the variance corrected for
/// ties and a continuity correction of 1/2. `automatic`: exact up to exactRankTestLimit values. No answer for an empty
/// group, values that are not finite, or when all values are tied.
Expected<MannWhitney> mannWhitney(std::span<const double> x, std::span<const double> y,
                                  RankTest method = RankTest::automatic);

/// p of the claim that `larger` exceeds `other` by less than the margin: `greater` of `other` shifted by it. With
/// `bothSides` the larger p of both directions: equivalence by two one-sided tests (Schuirmann 1987), of ranks.
/// @pre margin > 0
Expected<double> marginTest(std::span<const double> larger, std::span<const double> other, double margin,
                            bool bothSides);

/// p of mannWhitney() where groups of these sizes are separated completely, without ties: 2 / C(nx + ny, nx), at most
/// 1, up to exactRankTestLimit values. Ties make it larger. @pre nx, ny > 0
double smallestRankTestP(std::size_t nx, std::size_t ny);

/// Least n for which smallestRankTestP(n, n) is at most `p`. @pre p > 0
std::size_t leastGroups(double p);

/// Probability of superiority and its linear image; one statistic under two names.
struct Superiority {
  double a = 0.5;      ///< Vargha and Delaney's A = U / (nx ny): P(X > Y) + P(X = Y) / 2, the area under the ROC curve
  double delta = 0.0;  ///< Cliff's delta = 2 A - 1 = P(X > Y) - P(X < Y)
};
Expected<Superiority> superiority(std::span<const double> x, std::span<const double> y);

/// Hodges-Lehmann estimate of the shift: median of all x_i - y_j (positive: x is larger). O(nx ny) memory.
Expected<double> hodgesLehmann(std::span<const double> x, std::span<const double> y);

enum class ShiftMethod {
  exact,         ///< without ties
  conservative,  ///< ties: the closed interval at the quantiles of the distribution without ties covers at least as
                 ///< often
  asymptotic     ///< beyond exactShiftLimit values: the quantile of U by its normal approximation
};

const char* nameOf(ShiftMethod method);

struct ShiftInterval {
  double lower = 0.0, upper = 0.0;
  double attained = 0.0;  ///< exact: coverage that the discrete distribution really gives, >= the one asked for;
                          ///< conservative: its lower bound; asymptotic: the one asked for
  ShiftMethod method = ShiftMethod::exact;
};

/// Distribution-free interval of that shift: order statistics of the differences at the quantiles of the distribution
/// of U (Hollander and Wolfe 1999, 4.3); with ties, Noether (1967, J. Am. Stat. Assoc. 62:184). No answer where all
/// values are equal or the groups are too small for the level. @pre 0 < level < 1.
Expected<ShiftInterval> hodgesLehmannInterval(std::span<const double> x, std::span<const double> y,
                                              double level = 0.95);

/// Mid-ranks (1-based; tied values share the mean of their ranks), in the order of the values. @pre all finite.
std::vector<double> midRanks(std::span<const double> values);

/// Lower quantile of Mann-Whitney's U without ties.
struct RankSumQuantile {
  std::size_t u = 0;   ///< least u with P(U <= u) >= p: R's qwilcox(p, nx, ny)
  double below = 0.0;  ///< P(U < u), which is less than p
};

/// Counts w(k; m, n) of the orders of m and n values with U = k, by w(k; m, n) = w(k - n; m - 1, n) + w(k; m, n - 1)
/// (Mann and Whitney 1947): O(nx^2 ny^2) additions of positive numbers, so that the relative error stays below
/// (nx + ny) 2^-53. The quantiles that a thread has asked for are kept: figures of one study have few sizes.
/// @pre nx, ny > 0, 0 < p <= 1/2; nx + ny <= 1,000, beyond which counts overflow.
RankSumQuantile rankSumQuantile(std::size_t nx, std::size_t ny, double p);

/// One stratum (a site): values of both groups there.
struct Stratum {
  std::vector<double> x, y;
};

struct StratifiedRankSum {
  double z = 0.0;          ///< positive: x is larger
  double p = 1.0;          ///< two-sided, normal: an approximation
  std::size_t strata = 0;  ///< with both groups in them and values that differ; the others say nothing
  std::size_t left = 0;    ///< strata left out
  double a = 0.5;          ///< pooled P(X > Y) + P(X = Y) / 2, strata weighted by nx ny / (nx + ny + 1)
};

/// Van Elteren's test (1960, Bull. Int. Stat. Inst. 37:351): rank sums within strata, weighted by 1 / (N + 1),
/// mid-ranks with the variance corrected for ties; no continuity correction. No answer when no stratum compares, or
/// for values not finite.
Expected<StratifiedRankSum> stratifiedRankSum(std::span<const Stratum> strata);

struct HedgesG {
  double g = 0.0;  ///< J d
  double d = 0.0;  ///< Cohen's: (mx - my) / s, s^2 the pooled variance with nx + ny - 2
  double j = 1.0;  ///< small-sample correction
  /// "J times non-central t": the non-centralities at which t = d sqrt(nx ny / (nx + ny)) is the upper and the lower
  /// quantile, converted back to d, times J. Assumes normal groups of one variance.
  Expected<Interval> interval = NoResult{"not computed"};
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
