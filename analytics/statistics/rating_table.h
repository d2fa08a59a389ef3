// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace calot::analytics {

/// Complete table of numbers: a row a subject, a column a rater (or an item of a questionnaire).
struct RatingTable {
  std::size_t subjects = 0, raters = 0;
  std::vector<double> values;  ///< row after row

  [[nodiscard]] double at(std::size_t subject, std::size_t rater) const { return values[subject * raters + rater]; }
};

/// Why such a table has no agreement, or empty: size, fewer than two rows or columns, a value not finite, all equal.
std::string objection(const RatingTable& table);

/// Mean squares of the two-way analysis of variance without replication.
struct MeanSquares {
  double subjects = 0.0;  ///< n - 1 degrees of freedom
  double raters = 0.0;    ///< k - 1
  double residual = 0.0;  ///< (n - 1) (k - 1); exactly 0 where below the rounding of the values
};
/// @pre objection() is empty.
MeanSquares meanSquares(const RatingTable& table);

}  // namespace calot::analytics
