// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/figure_standing.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/statistics/descriptive.h"
#include "gui/words/problem_words.h"
#include "recorder/base/errors.h"

namespace calot::gui {
namespace {

std::vector<double> competentValues(const analytics::Norm& norm, std::size_t figure) {
  std::vector<double> values;
  for (const analytics::NormMember& member : norm.members) {
    if (member.competent && figure < member.values.size() && member.values[figure])
      values.push_back(*member.values[figure]);
  }
  std::sort(values.begin(), values.end());
  return values;
}

std::optional<FigureStanding::Band> bandOf(const std::vector<double>& sorted, double factor) {
  if (sorted.size() < analytics::leastForPercentile) return std::nullopt;
  const auto at = [&](double p) { return factor * analytics::quantileOfSorted(sorted, p); };
  return FigureStanding::Band{at(0.10), at(0.25), at(0.50), at(0.75), at(0.90)};
}

void judge(FigureStanding& standing, const analytics::GradedFigure& figure) {
  standing.passed = figure.passed;
  standing.open = figure.open;
  standing.undecided = figure.undecided;
  if (figure.rank) standing.percentile = *figure.rank;
  if (figure.passed) {
    standing.explanation = *figure.passed ? "On the passing side of the norm's cut." : "Falls short of the norm's cut.";
    if (figure.open) standing.explanation += " Within the cut's interval: another norm might judge otherwise.";
    if (figure.undecided)
      standing.explanation += " Not decided by this simulation: the cut lies within the value's interval.";
  } else if (!figure.missing.empty()) {
    standing.explanation = "Not judged: " + figure.missing + ".";
  }
  if (figure.rank)
    standing.explanation += fmt::format(" Percentile {:.0f} of {} competent members.", *figure.rank, figure.competent);
  else if (figure.value)
    standing.explanation += " No percentile: " + figure.rank.reason() + ".";
}

}  // namespace

std::vector<const analytics::Norm*> normsFor(const analytics::AttemptRow& attempt,
                                             const std::vector<analytics::Norm>& norms) {
  std::map<std::string, const analytics::Norm*> newest;
  for (const analytics::Norm& norm : norms) {
    if (norm.comparabilityKey != attempt.comparabilityKey) continue;
    const analytics::Norm*& kept = newest[norm.name];
    if (kept == nullptr || kept->version < norm.version) kept = &norm;
  }
  std::vector<const analytics::Norm*> result;
  result.reserve(newest.size());
  for (const auto& entry : newest) result.push_back(entry.second);
  return result;
}

AttemptStanding standingOf(const analytics::AttemptRow& attempt, const std::vector<analytics::CheckpointValue>& values,
                           const analytics::Norm& norm, const std::vector<analytics::ValueInterval>& intervals) {
  AttemptStanding standing;
  standing.norm = fmt::format("{} version {}", norm.name, norm.version);
  std::optional<analytics::Grade>& grade = standing.grade;
  try {
    // Alone: how the participant's attempts went over time is the trainee page's.
    std::vector<analytics::AttemptValue> own;
    own.reserve(values.size());
    for (const analytics::CheckpointValue& value : values) {
      const analytics::ValueInterval* interval = analytics::findInterval(intervals, value);
      own.push_back({attempt.uuid, value, interval != nullptr ? std::optional(*interval) : std::nullopt});
    }
    grade = analytics::gradeAttempt(attempt, {attempt}, own, norm, false, "this cohort");
    standing.verdict = grade->verdict;
    standing.judged = true;
  } catch (const Error& error) {
    standing.verdict = "Not judged: " + problemText(error);
  }
  for (std::size_t f = 0; f < norm.checkpoints.size(); ++f) {
    const analytics::NormCheckpoint& mark = norm.checkpoints[f];
    const analytics::CheckpointDefinition* definition =
        mark.metric ? &mark.metric->definition : analytics::findCheckpoint(mark.checkpoint);
    const double factor =
        definition != nullptr && definition->version == mark.version ? definition->displayFactor : 1.0;
    FigureStanding figure;
    figure.checkpoint = mark.checkpoint;
    figure.subject = mark.subject;
    figure.band = bandOf(competentValues(norm, f), factor);
    if (mark.cut) figure.cut = factor * *mark.cut;
    const auto value = std::find_if(values.begin(), values.end(), [&](const analytics::CheckpointValue& v) {
      return v.name == mark.checkpoint && v.subject == mark.subject && v.version == mark.version;
    });
    if (value != values.end() && value->value) figure.value = factor * *value->value;
    if (grade) {
      const auto graded = std::find_if(grade->figures.begin(), grade->figures.end(), [&](const auto& g) {
        return g.mark.checkpoint == mark.checkpoint && g.mark.subject == mark.subject;
      });
      if (graded != grade->figures.end()) judge(figure, *graded);
    }
    if (!figure.band)
      figure.explanation +=
          fmt::format(" No band: fewer than {} competent members have this figure.", analytics::leastForPercentile);
    standing.figures.push_back(std::move(figure));
  }
  return standing;
}

}  // namespace calot::gui
