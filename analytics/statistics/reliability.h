// SPDX-License-Identifier: GPL-3.0-or-later
// Agreement and repeatability of ratings and of attempts: intraclass correlation, internal consistency,
// generalizability theory of one crossed facet, error of measurement; of two methods that measured the same people:
// limits of agreement, Deming regression.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/expected.h"
#include "analytics/statistics/resampling.h"

namespace calot::analytics {

/// Complete table of numbers: a row a subject, a column a rater (or an item of a questionnaire).
struct RatingTable {
  std::size_t subjects = 0, raters = 0;
  std::vector<double> values;  ///< row after row

  [[nodiscard]] double at(std::size_t subject, std::size_t rater) const { return values[subject * raters + rater]; }
};

/// Reason why such a table has no agreement, or empty: size, fewer than two rows or columns, a value not finite, all
/// equal.
std::string objection(const RatingTable& table);

/// Mean squares of the two-way analysis of variance without replication; each exactly 0 where below the rounding of the
/// values.
struct MeanSquares {
  double subjects = 0.0;  ///< n - 1 degrees of freedom
  double raters = 0.0;    ///< k - 1
  double residual = 0.0;  ///< (n - 1) (k - 1)
};
/// @pre objection() is empty.
MeanSquares meanSquares(const RatingTable& table);

struct CronbachAlpha {
  double value = 0.0;
  Expected<Interval> interval = NoResult{"not computed"};
};

/// Internal consistency of a scale of k items (columns): k / (k - 1) (1 - sum of the items' variances / variance of the
/// sum) (Cronbach 1951, Psychometrika 16:297); equal to ICC(3,k). Interval: 1 - (1 - alpha) F at the quantiles of F
/// with n - 1 and (n - 1)(k - 1) degrees of freedom (Feldt 1965, Psychometrika 30:357). One subscale at a time: the
/// caller's duty. No answer for fewer than three items, as objection(table), and when the sums of all subjects are
/// equal; no interval where the items agree perfectly.
Expected<CronbachAlpha> cronbachAlpha(const RatingTable& items, double level = 0.95);

/// Three of the forms of Shrout and Fleiss (1979, Psychol. Bull. 86:420), by what the design is. 2: the raters are a
/// sample, and their leniency counts as error; 3: these raters alone, leniency apart. Single: reliability of one rater;
/// average: of the mean of all k.
enum class IccForm : std::uint8_t { twoSingle, twoAverage, threeAverage };

struct IntraclassCorrelation {
  double value = 0.0;  ///< may be negative
  Expected<Interval> interval = NoResult{"not computed"};
};

/// With mean squares S (subjects), R (raters), E (residual), n subjects and k raters:
///   ICC(2,1) = (S - E) / (S + (k - 1) E + k (R - E) / n)
///   ICC(2,k) = (S - E) / (S + (R - E) / n)
///   ICC(3,k) = (S - E) / S
/// Intervals from the F distribution, for ICC(2,.) with Satterthwaite's degrees of freedom (Shrout and Fleiss; McGraw
/// and Wong 1996, Psychol. Methods 1:30); that of ICC(2,k) is the single one's by Spearman and Brown. No answer as
/// objection(table), and where the denominator is not positive. No interval where the raters agree but for leniency.
Expected<IntraclassCorrelation> intraclassCorrelation(const RatingTable& table, IccForm form, double level = 0.95);

/// Reliability of a decision on the mean of k raters (occasions).
struct DecisionStudy {
  double g = 0.0;              ///< relative: p / (p + e / k), ranks people
  double phi = 0.0;            ///< absolute: p / (p + (f + e) / k), holds them against a mark
  double relativeError = 0.0;  ///< sqrt(e / k), the figure's unit
  double absoluteError = 0.0;  ///< sqrt((f + e) / k)
};

struct Generalizability {
  std::size_t groups = 1, people = 0, levels = 0;
  double person = 0.0;                                      ///< variance p of people
  double facet = 0.0;                                       ///< variance f of the raters' leniency, or of occasions
  double residual = 0.0;                                    ///< variance e of interaction and error
  double group = 0.0;                                       ///< of several: of their means, all being of the same size
  double common = 0.0;                                      ///< of f: what a level changes in all groups alike
  double interaction = 0.0;                                 ///< of f: what it changes in one group and not in another
  bool truncated = false;                                   ///< a negative estimate was set to 0
  Expected<Interval> gInterval = NoResult{"not computed"};  ///< of G with all levels, by the F distribution

  [[nodiscard]] DecisionStudy at(std::size_t k) const;  ///< @pre k > 0
};

/// Variance components of a complete table by the analysis of variance (Brennan 2001, Generalizability Theory, 3.2):
/// with mean squares S of people, R of raters and E of the rest, p = (S - E) / k, f = (R - E) / n, e = E. With all k
/// raters G is ICC(3,k) and Phi is ICC(2,k). No answer as objection(table).
///
/// With several tables, people nested in groups: S and E are pooled within groups, so that differences between groups
/// are no differences between people; f, the mean of the groups' (R - E) / n, holds what a level changes in each group.
/// Groups are fixed and count alike, and each component is what its source contributes to the variance of a value. With
/// C the variance of the levels' means over all groups, Q that of the groups' means, h groups of n people and 1 / n
/// their mean: common = C - E / (h n), interaction = f - common, group = (h - 1) / h (Q - S / (k n)) - interaction / k.
/// Brennan's variances of group and of interaction, both random, are h / (h - 1) times these, and his of the level is
/// common - interaction / (h - 1). Each is set to 0 by itself where it is negative. A group in which all is equal has
/// mean squares of 0. @pre all have the same levels
Expected<Generalizability> generalizability(std::span<const RatingTable> groups);
inline Expected<Generalizability> generalizability(const RatingTable& table) { return generalizability({&table, 1}); }

/// A share of the variance of a value within its group, p + f + e.
struct VarianceShare {
  double value = 0.0;
  Expected<Interval> interval = NoResult{"not computed"};
};

struct LevelShares {
  VarianceShare level;        ///< (f + e) / (p + f + e): all that depends on the level, alone or with group and person
  VarianceShare common;       ///< what a level changes in all alike
  VarianceShare interaction;  ///< what it changes in one group and not in another
  VarianceShare residual;     ///< e / (p + f + e): what it changes in one person and not in another
};

/// Shares of generalizability(), with percentile intervals of a bootstrap over people within their groups; levels stay
/// as they are. A resample's level means scatter by e / m beside what they do in the data, so twice E is taken off its
/// R and C (Brennan 2001, 6.3, on the bias of resampled components). No answer as generalizability() and where nothing
/// varies within groups. @pre as generalizability()
Expected<LevelShares> levelShares(std::span<const RatingTable> groups, const BootstrapOptions& options = {});

struct MeasurementError {
  std::size_t people = 0, attempts = 0;  ///< with two attempts or more
  double df = 0.0;                       ///< attempts less people
  double sem = 0.0;                      ///< standard error of measurement: deviation of a person's attempts
  double sdc = 0.0;                      ///< smallest detectable change of one person: 1.96 sqrt(2) SEM
  Interval semInterval, sdcInterval;
};

/// Deviation of attempts about their own participant's mean, pooled over participants with two attempts or more: SEM^2
/// = sum of squares / (attempts - people) (de Vet et al. 2006, J. Clin. Epidemiol. 59:1033; "agreement": a systematic
/// change from attempt to attempt counts as error). Interval from chi-squared, which assumes normal errors of one
/// variance. No answer for values not finite, nobody with two attempts, or attempts of each person all equal.
/// @pre 0 < level < 1.
Expected<MeasurementError> measurementError(std::span<const RepeatedValue> values, double level = 0.95);

/// Agreement of two methods that measured the same.
struct BlandAltman {
  std::size_t pairs = 0;
  double bias = 0.0;       ///< mean of first less second
  double deviation = 0.0;  ///< of the differences
  double lower = 0.0, upper = 0.0;
  Interval biasInterval, lowerInterval, upperInterval;
};

/// Limits of agreement bias -+ 1.96 s with Student's intervals of n - 1 degrees of freedom: the bias has the variance
/// s^2 / n, a limit s^2 (1 / n + 1.96^2 / (2 (n - 1))) (Bland and Altman 1999, Stat. Methods Med. Res. 8:135). Assumes
/// normal differences that do not depend on the size of what is measured, one pair of each participant. No answer for
/// lengths that differ, fewer than three pairs, values not finite, or differences all equal. @pre 0 < level < 1.
Expected<BlandAltman> blandAltman(std::span<const double> first, std::span<const double> second, double level = 0.95);

/// y = intercept + slope x, both measured with error.
struct DemingRegression {
  std::size_t pairs = 0;
  double intercept = 0.0, slope = 1.0;
  double interceptError = 0.0, slopeError = 0.0;  ///< jackknife
  Interval interceptInterval, slopeInterval;
};

/// With d the variance of y's errors over that of x's and S the sums of squares and products about the means:
///   slope = (Syy - d Sxx + sqrt((Syy - d Sxx)^2 + 4 d Sxy^2)) / (2 Sxy)
/// (Deming 1943). Errors by the jackknife: the deviation of the pseudo-values n b - (n - 1) b_i over the root of n;
/// intervals by Student's t with n - 2 degrees of freedom (Linnet 1993, Clin. Chem. 39:424). No answer for lengths that
/// differ, fewer than four pairs, values not finite, or a slope that is not determined, also without one pair.
/// @pre errorRatio > 0, 0 < level < 1.
Expected<DemingRegression> demingRegression(std::span<const double> x, std::span<const double> y,
                                            double errorRatio = 1.0, double level = 0.95);

}  // namespace calot::analytics
