// SPDX-License-Identifier: GPL-3.0-or-later
// Pass marks from raters' scores instead of from two groups: borderline regression.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "analytics/assessment/norm.h"
#include "analytics/statistics/expected.h"

namespace calot::analytics {

/// Group names of members by their rating.
inline constexpr const char* atMarkGroup = "at the mark or above";
inline constexpr const char* belowMarkGroup = "below the mark";

/// Attempts' ratings with a form: the mean of the items that a rater answered, of several raters the mean of these.
std::map<std::string, double> meanRatings(const std::vector<Rating>& ratings, const std::string& form);

/// The attempts with a group by their rating: at the borderline mark one is competent; of a participant the first that
/// was rated. Others have no group. @throws Error (refused) where no attempt was rated with the form.
std::vector<AttemptRow> groupedByRating(std::vector<AttemptRow> attempts, const std::map<std::string, double>& ratings,
                                        const BorderlineMark& borderline, const std::string& name);

/// Cut with its interval, of times on the log scale.
struct RegressionCut {
  double cut = 0.0, lower = 0.0, upper = 0.0;
};
Expected<RegressionCut> borderlineCut(const std::vector<double>& ratings, const std::vector<double>& values,
                                      double mark, Direction direction, bool logScale);

}  // namespace calot::analytics
