// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/gap_bridge.h"
#include "sim/math/no_fused_pairs.h"  // first

#include <algorithm>
#include <cmath>
#include <utility>

#include "recorder/sources/pointing.h"

namespace calot::analytics {
namespace {

constexpr double slopeWindow = 0.1;  // s

/// Times between two runs (s).
double between(const GridRun& before, const GridRun& after, double unitsPerSecond) {
  return (after.begin.time - before.end.time) / unitsPerSecond;
}

/// Least-squares slope (m/s) of the `points` first or last positions of a run. @pre points >= 2
Vec3 slopeOf(const std::vector<Vec3>& position, bool atEnd, std::size_t points) {
  const std::size_t from = atEnd ? position.size() - points : 0;
  const double middle = 0.5 * static_cast<double>(points - 1);
  Vec3 sum = Vec3::Zero();
  double squares = 0.0;
  for (std::size_t i = 0; i < points; ++i) {
    const double t = static_cast<double>(i) - middle;
    sum += t * position[from + i];
    squares += t * t;
  }
  return sum * (motionRate / squares);
}

/// Velocities at both ends of a gap, times its length: tangents of the Hermite curve (m).
struct Tangents {
  Vec3 begin, end;
};

Tangents tangentsOf(const GridRun& before, const GridRun& after, double seconds, double interval) {
  const Vec3 chord = after.begin.position - before.end.position;
  const auto window = static_cast<std::size_t>(std::floor(std::max(slopeWindow, interval) * motionRate + 0.5)) + 1;
  const auto tangent = [&](const GridRun& run, bool atEnd) -> Vec3 {
    const std::size_t points = std::min(window, run.position.size());
    if (points < 2) return chord;
    return slopeOf(run.position, atEnd, points) * seconds;
  };
  return {tangent(before, true), tangent(after, false)};
}

Vec3 hermite(const Vec3& from, const Vec3& to, const Tangents& tangents, double s) {
  const double s2 = s * s, s3 = s2 * s;
  return (2.0 * s3 - 3.0 * s2 + 1.0) * from + (s3 - 2.0 * s2 + s) * tangents.begin + (3.0 * s2 - 2.0 * s3) * to +
         (s3 - s2) * tangents.end;
}

/// Appends the points between both runs, then those of `after`.
void join(GridRun& before, GridRun&& after, const GapRule& rule, double unitsPerSecond) {
  const double seconds = between(before, after, unitsPerSecond);
  const bool straight = rule.isStraight(seconds);
  const Tangents tangents = straight ? Tangents{} : tangentsOf(before, after, seconds, rule.interval());
  const TimedPose from = before.end, &to = after.begin;
  const auto end = after.first;
  for (auto k = before.first + static_cast<std::int64_t>(before.position.size()); k < end; ++k) {
    const double s = (gridTime(k, unitsPerSecond) - from.time) / (to.time - from.time);
    before.append(straight ? Vec3(from.position + s * (to.position - from.position))
                           : hermite(from.position, to.position, tangents, s),
                  recorder::interpolated(from.orientation, to.orientation, s));
  }
  for (std::size_t i = 0; i < after.position.size(); ++i) before.append(after.position[i], after.orientation[i]);
  before.end = after.end;
}

template <class Takes>
std::vector<GridRun> joined(std::vector<GridRun> runs, const GapRule& rule, double unitsPerSecond, Takes takes) {
  std::vector<GridRun> result;
  for (GridRun& run : runs) {
    if (run.continues && !result.empty() && takes(between(result.back(), run, unitsPerSecond))) {
      join(result.back(), std::move(run), rule, unitsPerSecond);
    } else {
      result.push_back(std::move(run));
    }
  }
  return result;
}

}  // namespace

std::vector<GridRun> bridged(std::vector<GridRun> runs, const GapRule& rule, double unitsPerSecond) {
  // Straight ones first: what they join gives the slopes of the curves.
  runs = joined(std::move(runs), rule, unitsPerSecond, [&](double seconds) { return rule.isStraight(seconds); });
  return joined(std::move(runs), rule, unitsPerSecond, [&](double seconds) { return rule.isBridged(seconds); });
}

}  // namespace calot::analytics
