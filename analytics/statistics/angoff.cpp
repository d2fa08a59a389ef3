// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/statistics/angoff.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/distributions.h"

namespace calot::analytics {

Expected<AngoffCut> angoffCut(const RatingTable& judged, double level) {
  using Result = Expected<AngoffCut>;
  if (judged.subjects < 2) return Result::none("fewer than two judges");
  if (judged.raters < 1) return Result::none("no item");
  if (!std::all_of(judged.values.begin(), judged.values.end(), [](double p) { return p >= 0.0 && p <= 1.0; }))
    return Result::none("a probability is outside of 0 to 1");
  std::vector<double> marks;
  for (std::size_t judge = 0; judge < judged.subjects; ++judge) {
    double sum = 0.0;
    for (std::size_t item = 0; item < judged.raters; ++item) sum += judged.at(judge, item);
    marks.push_back(sum);
  }
  AngoffCut result;
  const double n = static_cast<double>(marks.size());
  result.cut = *mean(marks);
  result.error = *standardDeviation(marks) / std::sqrt(n);
  // Sums of rounded probabilities differ in the last bits where the judges agree.
  if (!(result.error > 1e-12 * static_cast<double>(judged.raters)))
    return Result::none("all judges have the same mark");
  const double half = studentQuantile(0.5 + level / 2.0, n - 1.0) * result.error;
  result.interval = {result.cut - half, result.cut + half, level, "Student's t over the judges"};
  return result;
}

}  // namespace calot::analytics
