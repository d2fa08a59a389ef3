// SPDX-License-Identifier: GPL-3.0-or-later
// Several groups by ranks (Kruskal and Wallis, Dunn), two groups of unequal spread (Brunner and Munzel), Spearman's
// rank correlation, and many tests at once: adjusted p values, to be compared with the level, in the order of the
// input.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analytics/statistics/expected.h"
#include "analytics/statistics/two_groups.h"

namespace calot::analytics {

struct KruskalWallis {
  double h = 0.0;   ///< corrected for ties
  double df = 0.0;  ///< groups less one
  double p = 1.0;   ///< chi-squared: an approximation, rough where groups have fewer than five values
  /// H / (N - 1), in [0, 1]: share of the ranks' variance that lies between the groups (Kelley 1935, Proc. Natl. Acad.
  /// Sci. 21:554; of ranks, Tomczak and Tomczak 2014, Trends Sport Sci. 21:19).
  double epsilonSquared = 0.0;
};

/// Kruskal and Wallis (1952, J. Am. Stat. Assoc. 47:583), with mean ranks r_g of N pooled values and t values per tie:
///   H = 12 / (N (N + 1)) sum n_g (r_g - (N + 1) / 2)^2 / (1 - sum(t^3 - t) / (N^3 - N)).
/// No answer for fewer than two groups, an empty one, or when all values are equal.
Expected<KruskalWallis> kruskalWallis(std::span<const std::vector<double>> groups);

/// Two of the groups, by their places in the input.
struct DunnPair {
  std::size_t first = 0, second = 0;
  double z = 0.0;         ///< positive: the first has the higher ranks
  double p = 1.0;         ///< two-sided, alone
  double adjusted = 1.0;  ///< Holm over all pairs
};

/// Dunn's comparisons of all pairs on the ranks of the whole (Dunn 1964, Technometrics 6:241):
///   z = (r_a - r_b) / sqrt((N (N + 1) / 12 - sum(t^3 - t) / (12 (N - 1))) (1 / n_a + 1 / n_b)).
/// Pairs in the order (0,1), (0,2), ..., (1,2), ... Same preconditions as kruskalWallis().
Expected<std::vector<DunnPair>> dunn(std::span<const std::vector<double>> groups);

struct BrunnerMunzel {
  double statistic = 0.0;  ///< positive: x is larger; infinite where the groups do not overlap
  double df = 0.0;         ///< of Student's t; 0 where the groups do not overlap
  double p = 1.0;          ///< two-sided
  bool exact = false;      ///< by assignments of the values to the groups, all or drawn; else by Student's t
};

/// Assignments that are all gone through, or that are drawn (seed 1) where there are more.
inline constexpr std::size_t brunnerMunzelAssignments = 9999;

/// Brunner and Munzel's test of A = 1/2 (2000, Biom. J. 42:17), for groups of unequal spread. With the placement P of a
/// value, the number of values of the other group below it (ties half), and the placements' variances s^2:
///   (A - 1/2) / sqrt(sx^2 / (nx ny^2) + sy^2 / (ny nx^2)), df by Satterthwaite.
/// `exact`: P(|statistic| as large) over all assignments (Neubert and Brunner 2007, Comput. Stat. Data Anal. 51:5192);
/// `automatic`: up to exactRankTestLimit values the larger p of both, with drawn assignments where there are more than
/// brunnerMunzelAssignments; it keeps the level where people differ in nothing, and nearly where they differ in spread.
/// No answer as mannWhitney(), for a group of one, or for `asymptotic` where the groups do not overlap.
Expected<BrunnerMunzel> brunnerMunzel(std::span<const double> x, std::span<const double> y,
                                      RankTest method = RankTest::automatic);

struct Spearman {
  double rho = 0.0;
  double p = 1.0;      ///< two-sided
  bool exact = false;  ///< over all orders; else by Student's t
  bool ties = false;
};

/// Pairs up to which all n! orders are gone through.
inline constexpr std::size_t exactSpearmanLimit = 9;

/// Spearman's rank correlation (1904): Pearson's of the mid-ranks. Exact: the share of all orders of one variable in
/// which |rho| is at least as large, ties included. Beyond exactSpearmanLimit pairs t = rho sqrt((n - 2) / (1 - rho^2))
/// with n - 2 degrees of freedom (Kendall and Stuart), and for |rho| = 1, where t is infinite, the bound 2 prod(t!) /
/// n! over the ties. No answer for lengths that differ, fewer than three pairs, or a variable with all values equal.
Expected<Spearman> spearman(std::span<const double> x, std::span<const double> y);

/// tanh(atanh rho -+ z sqrt((1 + rho^2 / 2) / (n - 3))) (Bonett and Wright 2000, Psychometrika 65:23). No answer for
/// fewer than four pairs or |rho| = 1, where it would be a point. @pre 0 < level < 1.
Expected<Interval> spearmanInterval(double rho, std::size_t n, double level = 0.95);

/// Holm (1979, Scand. J. Stat. 6:65): with p_(1) <= ... <= p_(m), max over j <= i of min(1, (m - j + 1) p_(j)).
/// Controls the familywise error rate under any dependence: for primary questions. No answer for no p values or one
/// outside of [0, 1].
Expected<std::vector<double>> holm(std::span<const double> p);

/// Benjamini and Hochberg (1995, J. R. Stat. Soc. B 57:289): min over j >= i of min(1, m p_(j) / j). Controls the false
/// discovery rate for independent or positively dependent tests: for exploration. Same preconditions as holm().
Expected<std::vector<double>> benjaminiHochberg(std::span<const double> p);

}  // namespace calot::analytics
