// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "analytics/statistics/expected.h"

namespace calot::analytics {

struct PermutationOptions {
  std::uint64_t maxAssignments = 200000;  ///< up to this number, all are enumerated (ten against ten: 184,756)
  std::uint64_t draws = 99999;            ///< beyond: number of random ones
  std::uint64_t seed = 1;
};

struct PermutationTest {
  double difference = 0.0;  ///< mean of x less mean of y
  double p = 1.0;           ///< two-sided
  bool exact = false;
  std::uint64_t assignments = 0;      ///< enumerated or drawn
  std::optional<std::uint64_t> seed;  ///< of the random ones
};

/// Permutation test of the difference of two means (Fisher and Pitman): the share of all assignments of the pooled
/// values to groups of these sizes whose difference is at least as large, either way. Drawn at random: p = (1 + hits) /
/// (1 + draws), which keeps the level (Phipson and Smyth 2010, Stat. Appl. Genet. Mol. Biol. 9:39). Sums that differ by
/// less than 1e-11 of the sum of all |values - mean| count as equal, so that rounding decides nothing. No answer for an
/// empty group or when all values are equal. @pre draws > 0.
Expected<PermutationTest> permutationTest(std::span<const double> x, std::span<const double> y,
                                          const PermutationOptions& options = {});

}  // namespace calot::analytics
