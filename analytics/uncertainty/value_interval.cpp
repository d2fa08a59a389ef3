// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/uncertainty/value_interval.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "analytics/uncertainty/uncertainty.h"

namespace calot::analytics {
namespace {

/// The value of the same checkpoint and subject, or null.
const CheckpointValue* sameIn(const std::vector<CheckpointValue>& values, const CheckpointValue& of) {
  const auto found = std::find_if(values.begin(), values.end(), [&](const CheckpointValue& v) {
    return v.name == of.name && v.subject == of.subject && v.version == of.version;
  });
  return found == values.end() ? nullptr : &*found;
}

/// The number, or a reason why there is none in these runs.
std::optional<double> valueIn(const std::vector<CheckpointValue>& values, const CheckpointValue& of,
                              const std::string& where, std::string& reason) {
  const CheckpointValue* found = sameIn(values, of);
  if (found != nullptr && found->value) return found->value;
  reason = fmt::format("it has no value {}{}", where, found == nullptr ? "" : ": " + found->reason);
  return std::nullopt;
}

/// Variance of the value over the assumed constants.
double varianceOf(const std::vector<double>& design) {
  double variance = 0.0;
  for (std::size_t f = 0; f < designFactors; ++f) {
    double effect = 0.0;
    for (std::size_t run = 0; run < designRuns; ++run) effect += designSign(run, f) * design[run];
    effect /= static_cast<double>(designRuns);
    variance += effect * effect / 3.0;
  }
  return variance;
}

ValueInterval intervalOf(const CheckpointValue& of, const VariedValues& varied) {
  ValueInterval interval{of.name, of.subject, of.version, *of.value, 0.0, 0.0, 0.0, {}, {}, {}, {}};
  const auto smallerStep = valueIn(varied.smallerStep, of, "in smaller steps", interval.reason);
  const auto finerMesh = valueIn(varied.finerMesh, of, "with a finer mesh", interval.reason);
  std::vector<double> design;
  for (const auto& run : varied.design) {
    if (const auto value = valueIn(run, of, "with other constants", interval.reason)) design.push_back(*value);
  }
  if (!interval.reason.empty()) return interval;
  const double v = *of.value;
  interval.stepEffect = (*smallerStep - v) * varied.stepRatio / (varied.stepRatio - 1.0);
  interval.meshEffect = (*finerMesh - v) * varied.meshRatio / (varied.meshRatio - 1.0);
  const double variance = varianceOf(design);
  interval.constantsSpread = std::sqrt(variance);
  const double half = std::sqrt(interval.stepEffect * interval.stepEffect + interval.meshEffect * interval.meshEffect +
                                coverageFactor * coverageFactor * variance);
  double lower = std::min(v, interval.limit()) - half;
  const bool neverBelowZero = v >= 0.0 && *smallerStep >= 0.0 && *finerMesh >= 0.0 &&
                              std::all_of(design.begin(), design.end(), [](double d) { return d >= 0.0; });
  if (neverBelowZero) lower = std::max(0.0, lower);
  interval.lower = lower;
  interval.upper = std::max(v, interval.limit()) + half;
  interval.runs = std::move(design);
  return interval;
}

}  // namespace

const ValueInterval* findInterval(const std::vector<ValueInterval>& intervals, const CheckpointValue& of) {
  const auto found = std::find_if(intervals.begin(), intervals.end(),
                                  [&](const ValueInterval& i) { return i.name == of.name && i.subject == of.subject; });
  return found == intervals.end() ? nullptr : &*found;
}

std::vector<double> ValueInterval::worlds() const {
  if (!lower) return {};
  std::vector<double> all{value, value + stepEffect, value + meshEffect, limit()};
  all.insert(all.end(), runs.begin(), runs.end());
  return all;
}

std::vector<ValueInterval> intervalsOf(const std::vector<CheckpointValue>& values, const VariedValues& varied) {
  assert(varied.stepRatio > 1.0 && varied.meshRatio > 1.0 && varied.design.size() == designRuns);
  std::vector<ValueInterval> intervals;
  for (const CheckpointValue& value : values) {
    if (value.value) intervals.push_back(intervalOf(value, varied));
  }
  return intervals;
}

}  // namespace calot::analytics
