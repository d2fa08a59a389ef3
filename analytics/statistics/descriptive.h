// SPDX-License-Identifier: GPL-3.0-or-later
// Descriptive statistics, checks of input, ties, and the rules by which several attempts of one person, which are not
// independent, become one value (the random-intercept model of mixed_models.h is the alternative).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analytics/statistics/expected.h"

namespace calot::analytics {

/// Arithmetic mean. No answer for no values or for values that are not finite.
Expected<double> mean(std::span<const double> values);

/// Sample standard deviation (divisor n - 1, two passes). No answer for fewer than two values.
Expected<double> standardDeviation(std::span<const double> values);

/// Sample quantile of type 7 (Hyndman and Fan 1996; the default of R and NumPy): with h = (n - 1) p, linear between the
/// order statistics around h. @pre 0 <= p <= 1.
Expected<double> quantile(std::span<const double> values, double p);

/// The same of values that are sorted ascending and finite. @pre not empty.
double quantileOfSorted(std::span<const double> sorted, double p);

/// Quantile of type 7 at 1/2.
Expected<double> median(std::span<const double> values);

/// Without values, or with one that is not finite, their number alone.
struct Summary {
  std::uint64_t n = 0;
  std::optional<double> mean, standardDeviation, median, lowerQuartile, upperQuartile;
};
Summary summaryOf(std::span<const double> values);

/// Neither NaN nor infinite.
bool allFinite(std::span<const double> values);

/// Reason why two groups cannot be compared, or empty: a group is empty, a value is not finite.
std::string twoGroupObjection(std::span<const double> x, std::span<const double> y);

/// The values of x, then those of y.
std::vector<double> pooled(std::span<const double> x, std::span<const double> y);

/// Sum of t^3 - t over the sets of t equal values: the correction for ties of every rank test; 0 without ties, and n^3
/// - n where all n values are equal.
double tieTerm(std::span<const double> values);

struct RepeatedValue {
  std::size_t participant = 0;
  double order = 0.0;  ///< of that participant's attempts: number or time
  double value = 0.0;
};

enum class AttemptRule : std::uint8_t { first, mean };

struct ParticipantValue {
  std::size_t participant = 0;
  double value = 0.0;
  std::size_t attempts = 0;  ///< that there were
};

/// One value per participant, by ascending participant. No answer for no values, one that is not finite, or, for
/// `first`, two attempts of a participant with one order.
Expected<std::vector<ParticipantValue>> onePerParticipant(std::span<const RepeatedValue> values, AttemptRule rule);

}  // namespace calot::analytics
