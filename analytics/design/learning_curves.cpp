// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/design/learning_curves.h"

#include <map>
#include <utility>

#include "analytics/statistics/resampling.h"

namespace calot::analytics {
namespace {

using AttemptMeans = std::map<double, std::pair<double, std::size_t>>;  // sum and number, by attempt

void addCourse(AttemptMeans& means, const PersonalCourse& course) {
  for (std::size_t i = 0; i < course.attempt.size(); ++i) {
    auto& [sum, count] = means[course.attempt[i]];
    sum += course.value[i];
    ++count;
  }
}

/// Means of the attempts that at least half of `people` made.
void keepCommon(const AttemptMeans& means, std::size_t people, GroupCurve& curve) {
  for (const auto& [attempt, of] : means) {
    if (2 * of.second < people) continue;
    curve.attempt.push_back(attempt);
    curve.mean.push_back(of.first / static_cast<double>(of.second));
  }
}

}  // namespace

GroupCurve groupCurve(const std::vector<PersonalCourse>& courses, std::size_t resamples) {
  GroupCurve result;
  AttemptMeans means;
  std::vector<double> indices;
  for (const PersonalCourse& course : courses) {
    addCourse(means, course);
    indices.push_back(static_cast<double>(indices.size()));
    result.attempts += course.attempt.size();
  }
  result.participants = courses.size();
  keepCommon(means, courses.size(), result);
  result.curve = fitLearningCurve(result.attempt, result.mean);
  if (!result.curve || resamples == 0) return result;
  if (courses.size() < 3) {
    result.plateau = NoResult{"fewer than three participants"};
    return result;
  }
  const auto plateauOf = [&](std::span<const double> drawn) -> Expected<double> {
    AttemptMeans sums;
    for (const double index : drawn) addCourse(sums, courses[static_cast<std::size_t>(index)]);
    GroupCurve resampled;
    keepCommon(sums, drawn.size(), resampled);
    const Expected<LearningCurve> curve = fitLearningCurve(resampled.attempt, resampled.mean);
    return curve ? Expected<double>(curve->plateau) : NoResult{curve.reason()};
  };
  BootstrapOptions options;
  options.resamples = resamples;
  const Expected<Bootstrap> interval = bootstrap(indices, plateauOf, options);
  result.plateau = interval ? Expected<Interval>(interval->interval) : NoResult{interval.reason()};
  return result;
}

}  // namespace calot::analytics
