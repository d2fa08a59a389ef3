// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "analytics/checkpoints/collector.h"
#include "recorder/sources/tracked_motion.h"

#include "sim/math/no_fused_pairs.h"  // first

namespace calot::analytics {
namespace {

/// A longer interval, in the tracker's own, hides a sample whose pose equalled the previous one.
constexpr double hiddenSample = 1.5;

/// A measured row that begins a pose.
struct PoseStart {
  std::size_t row = 0;   ///< number among the measured ones
  double time = 0.0;     ///< s
  bool follows = false;  ///< straightBridge or less after the pose before
};

/// Times of a tracker that is slower than the rows in which its poses are repeated. A pose appears in the first row
/// after its measurement, up to a row late, which third derivatives do not forgive: the times become those of the
/// tracker's own even clock where they lie within 1.5 rows of it, for 95 % of the poses.
void evenOut(std::vector<PoseStart>& poses, double rowInterval) {
  constexpr double leastRows = 1.5, tolerance = 1.5, leastShare = 0.95;
  std::vector<double> steps;
  for (std::size_t k = 1; k < poses.size(); ++k) {
    if (poses[k].follows) steps.push_back(poses[k].time - poses[k - 1].time);
  }
  if (steps.size() < 10) return;
  std::vector<double> sorted = steps;
  std::sort(sorted.begin(), sorted.end());
  const double longest = gapIntervals * sorted[sorted.size() / 2];
  double sum = 0.0, count = 0.0;
  for (const double step : steps) {
    if (step > longest) continue;
    sum += step;
    count += 1.0;
  }
  const double mean = sum / count;
  if (mean < leastRows * rowInterval) return;
  std::vector<double> number(poses.size(), 0.0);  // of the tracker's interval
  double n = 0.0, t = 0.0, nn = 0.0, nt = 0.0;
  const double origin = poses.front().time, all = static_cast<double>(poses.size());
  for (std::size_t k = 0; k < poses.size(); ++k) {
    if (k > 0) {
      const double since = poses[k].time - poses[k - 1].time;
      number[k] = number[k - 1] + std::max(1.0, std::floor(since / mean + 0.5));
    }
    const double seconds = poses[k].time - origin;
    n += number[k];
    t += seconds;
    nn += number[k] * number[k];
    nt += number[k] * seconds;
  }
  const double interval = (all * nt - n * t) / (all * nn - n * n);
  // A pose cannot appear before it is measured: the clock's phase is that of the earliest.
  std::vector<double> late(poses.size());
  for (std::size_t k = 0; k < poses.size(); ++k) late[k] = poses[k].time - interval * number[k];
  std::vector<double> order = late;
  const auto early = order.begin() + static_cast<std::ptrdiff_t>(order.size() / 50);
  std::nth_element(order.begin(), early, order.end());
  const double phase = *early;
  const auto fits = [&](double l) { return std::abs(l - phase) <= tolerance * rowInterval; };
  if (static_cast<double>(std::count_if(late.begin(), late.end(), fits)) < leastShare * all) return;
  std::vector<PoseStart> even = poses;
  for (std::size_t k = 1; k < poses.size(); ++k) {
    if (poses[k].follows && fits(late[k])) even[k].time = phase + interval * number[k];
    if (!(even[k].time > even[k - 1].time)) return;
  }
  poses = std::move(even);
}

/// Does the motion go on elsewhere after a row, up to another?
bool isDivided(const recorder::TrackedHand& hand, std::size_t after, std::size_t to) {
  const auto jump = std::upper_bound(hand.jumps.begin(), hand.jumps.end(), after);
  return jump != hand.jumps.end() && *jump <= to;
}

}  // namespace

Motion motionOf(const recorder::TrackedMotion& tracked, std::size_t hand, double cutoff) {
  const recorder::TrackedHand& rows = tracked.hand[hand];
  Motion motion;
  motion.cutoff = cutoff;
  if (!rows.present) return motion;
  // Rows of a fixed rate are counted, so that no time is rounded.
  const bool counted = tracked.rate > 0.0;
  MotionSamples samples{SampleGrid(counted ? tracked.rate : 1.0), {}, 0.0, {}, rows.oriented};
  const double units = samples.grid.unitsPerSecond();
  const auto timeOf = [&](std::size_t i) { return counted ? static_cast<double>(i) : tracked.time[i]; };
  const auto between = [&](std::size_t from, std::size_t to) { return (timeOf(to) - timeOf(from)) / units; };
  std::vector<std::size_t> measured;
  SampleRate rowRate;
  for (std::size_t i = 0; i < rows.position.size(); ++i) {
    if (i > 0) rowRate.add(counted ? 1.0 / tracked.rate : between(i - 1, i));
    if (!rows.isMissing(i)) measured.push_back(i);
  }
  const GapRule rule{rowRate.interval()};
  samples.coverage.mounted = {{0.0, tracked.time.back()}};
  for (std::size_t i = 1; i < rows.position.size(); ++i) {
    const double since = between(i - 1, i);
    if (rule.isGap(since)) samples.coverage.lost.push_back({tracked.time[i] - rule.lost(since), tracked.time[i]});
    if (rows.isMissing(i - 1) || measured.empty())
      samples.coverage.lost.push_back({tracked.time[i - 1], tracked.time[i]});
  }

  // A repeated pose is no sample: it was held, or for longer than sources hold one it was rest, as in MotionTrack.
  const auto begins = [&](std::size_t m) {  // a run, or the motion elsewhere
    return m == 0 || between(measured[m - 1], measured[m]) > straightBridge ||
           isDivided(rows, measured[m - 1], measured[m]);
  };
  std::vector<PoseStart> poses;
  for (std::size_t m = 0; m < measured.size(); ++m) {
    const std::size_t i = measured[m];
    const bool repeats = m > 0 && rows.position[i] == rows.position[measured[m - 1]] &&
                         rows.orientationAt(i).coeffs() == rows.orientationAt(measured[m - 1]).coeffs();
    if (begins(m) || !repeats)
      poses.push_back({m, timeOf(i) / units, !begins(m) && between(measured[poses.back().row], i) <= straightBridge});
  }
  const bool repeated = poses.size() < measured.size();
  std::vector<PoseStart> even = poses;
  if (repeated) evenOut(even, rowRate.interval());
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const std::size_t m = poses[k].row, i = measured[m];
    const std::size_t last = (k + 1 < poses.size() ? poses[k + 1].row : measured.size()) - 1;
    const double time = even[k].time == poses[k].time ? timeOf(i) : even[k].time * units;
    if (begins(m)) {
      if (m > 0 && between(measured[m - 1], i) <= SampleRate::longestInterval && poses[k - 1].row + 1 == m)
        samples.rate.add(between(measured[m - 1], i));
      samples.grid.begin(time, rows.position[i], rows.orientationAt(i), m > 0 && !isDivided(rows, measured[m - 1], i));
    } else {
      const bool kept = even[k].time == poses[k].time && even[k - 1].time == poses[k - 1].time;
      if (poses[k].follows)
        samples.rate.add(kept ? between(measured[poses[k - 1].row], i) : even[k].time - even[k - 1].time);
      samples.grid.extend(time, rows.position[i], rows.orientationAt(i));
    }
    if (between(i, measured[last]) > straightBridge)  // rest
      samples.grid.extend(timeOf(measured[last]), rows.position[i], rows.orientationAt(i));
  }
  const double own = samples.rate.interval();
  samples.longestRate = repeated ? hiddenSample * own : GapRule{own}.longestEven();
  motion = filteredMotion(std::move(samples), cutoff);
  motion.leftOut = rows.leftOut;
  return motion;
}

}  // namespace calot::analytics
