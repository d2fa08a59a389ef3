// SPDX-License-Identifier: GPL-3.0-or-later
// How both hands' speeds go together, and which hand goes first.
#include "analytics/checkpoints/checkpoint.h"

#include <fmt/format.h>

#include "analytics/checkpoints/two_hands.h"

namespace calot::analytics {
namespace {

constexpr std::int64_t farthestLag = 100;  ///< points: 1 s
constexpr const char* tooStill = "the speed of a hand does not vary by 0.1 mm/s while both are measured";

CheckpointDefinition ofBoth(CheckpointDefinition d) {
  d.window = "whole attempt, while both hands are mounted and measured";
  d.aggregation = Aggregation::attempt;
  d.instruments = "both hands together";
  return d;
}

const CheckpointDefinition& correlationDefinition() {
  static const CheckpointDefinition d = ofBoth(
      motionDefinition("bimanual-correlation", "Correlation of both hands' speeds", "1", Direction::none,
                       "Pearson's correlation of v_left(k) and v_right(k), v as in speed-mean, over the points at "
                       "which both hands are measured"));
  return d;
}

const CheckpointDefinition& lagDefinition() {
  static const CheckpointDefinition d = ofBoth(
      motionDefinition("bimanual-lag", "Lag of the right hand behind the left", "s", Direction::none,
                       "the l within 1 s either way for which the correlation of v_left(t) and v_right(t + l) is "
                       "greatest, if above 0; positive: the right hand follows"));
  return d;
}

Measured correlation(const Motion& left, const Motion& right, const AttemptContext& /*context*/) {
  const std::optional<double> c = speedCorrelation(left, right);
  return c ? Measured::of(*c) : Measured::notApplicable(tooStill);
}

Measured lag(const Motion& left, const Motion& right, const AttemptContext& /*context*/) {
  const std::optional<LaggedCorrelation> best = greatestSpeedCorrelation(left, right, farthestLag);
  if (!best) return Measured::notApplicable(tooStill);
  // The least bad of what doesn't go together is no lag.
  if (!(best->correlation > 0.0))
    return Measured::notApplicable("the hands' speeds do not go together at any lag within 1 s");
  return Measured::of(static_cast<double>(best->lag) / motionRate,
                      fmt::format("correlation {:.3f}", best->correlation));
}

}  // namespace

std::vector<CheckpointEntry> bimanualEntries() {
  return {{{CheckpointFamily::motion, 130},
           correlationDefinition(),
           [](const AttemptContext& context) { return ofBothHands(correlationDefinition(), correlation, context); }},
          {{CheckpointFamily::motion, 140}, lagDefinition(), [](const AttemptContext& context) {
             return ofBothHands(lagDefinition(), lag, context);
           }}};
}

}  // namespace calot::analytics
