// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace calot::analytics {

/// Permutation distribution of the sum of the mid-ranks of one group of `n`, when every choice of n of the N pooled
/// values is equally likely: exact with ties. Counted by dynamic programming over the pooled values (one value after
/// the other is in the group or not): O(N n S) with S the largest sum in half ranks. Counts are exact integers while
/// C(N, n) < 2^53 and carry a relative error below N * 2^-53 beyond, since all terms are positive.
class RankSumDistribution {
 public:
  /// @param midRanks of the pooled values (multiples of 1/2); @pre 0 < n < midRanks.size().
  RankSumDistribution(std::span<const double> midRanks, std::size_t n);

  [[nodiscard]] double atMost(double sum) const;   ///< P(S <= sum)
  [[nodiscard]] double atLeast(double sum) const;  ///< P(S >= sum)
  [[nodiscard]] double expected() const { return expected_; }
  /// P(|S - E S| >= |sum - E S|): both tails as far out as the observed sum.
  [[nodiscard]] double asFarAs(double sum) const;

 private:
  [[nodiscard]] double between(long lower, long upper) const;  ///< probability of half-rank sums in [lower, upper]
  std::vector<double> count_;                                  ///< by half-rank sum
  double total_ = 0.0;
  double expected_ = 0.0;
};

/// Mid-ranks (1-based; tied values share the mean of their ranks), in the order of the values. @pre all finite.
std::vector<double> midRanks(std::span<const double> values);

}  // namespace calot::analytics
