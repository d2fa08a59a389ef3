// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "analytics/statistics/expected.h"
#include "analytics/statistics/regression.h"

namespace calot::analytics {

/// A participant's values over the number of the attempt.
struct PersonalCourse {
  std::vector<double> attempt, value;
};

struct GroupCurve {
  std::vector<double> attempt, mean;  ///< attempts that at least half of the participants made
  std::size_t participants = 0, attempts = 0;
  Expected<LearningCurve> curve = NoResult{"not computed"};
  /// Interval of the plateau: percentile bootstrap over participants, each with all attempts.
  Expected<Interval> plateau = NoResult{"not computed"};
};

/// Curve through the means of each attempt. Values of one participant are not independent, so the fit's own errors are
/// not used. @param resamples 0: no interval @pre courses not empty
GroupCurve groupCurve(const std::vector<PersonalCourse>& courses, std::size_t resamples);

}  // namespace calot::analytics
