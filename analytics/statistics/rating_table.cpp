// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/rating_table.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/samples.h"

namespace calot::analytics {

std::string objection(const RatingTable& table) {
  if (table.values.size() != table.subjects * table.raters) return "the table is not complete";
  if (table.subjects < 2) return "fewer than two subjects";
  if (table.raters < 2) return "fewer than two columns";
  if (!allFinite(table.values)) return "a value is not finite";
  if (std::all_of(table.values.begin(), table.values.end(), [&](double v) { return v == table.values.front(); }))
    return "all values are equal";
  return {};
}

MeanSquares meanSquares(const RatingTable& table) {
  const double n = static_cast<double>(table.subjects), k = static_cast<double>(table.raters);
  const double grand = *mean(table.values);
  std::vector<double> row(table.subjects, 0.0), column(table.raters, 0.0);
  for (std::size_t i = 0; i < table.subjects; ++i) {
    for (std::size_t j = 0; j < table.raters; ++j) {
      row[i] += (table.at(i, j) - grand) / k;
      column[j] += (table.at(i, j) - grand) / n;
    }
  }
  double rows = 0.0, columns = 0.0, rest = 0.0, largest = 0.0;
  for (const double r : row) rows += k * r * r;
  for (const double c : column) columns += n * c * c;
  for (std::size_t i = 0; i < table.subjects; ++i) {
    for (std::size_t j = 0; j < table.raters; ++j) {
      const double e = table.at(i, j) - grand - row[i] - column[j];
      rest += e * e;
      largest = std::max(largest, std::abs(table.at(i, j)));
    }
  }
  // What rounding alone leaves of an exact fit: some units in the last place of the values, squared.
  const double last = 8.0 * std::numeric_limits<double>::epsilon() * largest, rounding = n * k * last * last;
  if (rest < rounding) rest = 0.0;
  if (rows < rounding) rows = 0.0;
  if (columns < rounding) columns = 0.0;
  return {rows / (n - 1.0), columns / (k - 1.0), rest / ((n - 1.0) * (k - 1.0))};
}

}  // namespace calot::analytics
