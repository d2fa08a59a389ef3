// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "analytics/checkpoints/gap_bridge.h"
#include "analytics/checkpoints/movements.h"
#include "analytics/checkpoints/zero_phase_filter.h"

namespace calot::analytics {
namespace {

std::vector<double> speeds(const std::vector<Vec3>& p) {
  const std::size_t n = p.size();
  std::vector<double> speed(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t a = i == 0 ? 0 : i - 1, b = i + 1 == n ? i : i + 1;
    const double dx = p[b].x() - p[a].x(), dy = p[b].y() - p[a].y(), dz = p[b].z() - p[a].z();
    speed[i] = std::sqrt(dx * dx + dy * dy + dz * dz) * (motionRate / static_cast<double>(b - a));
  }
  return speed;
}

std::vector<Vec3> smoothPositions(const ZeroPhaseFilter& filter, const std::vector<Vec3>& raw) {
  std::vector<Vec3> smooth(raw.size());
  std::vector<double> axis(raw.size());
  for (int a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < axis.size(); ++i) axis[i] = raw[i][a];
    const std::vector<double> y = filter.apply(axis);
    for (std::size_t i = 0; i < axis.size(); ++i) smooth[i][a] = y[i];
  }
  return smooth;
}

std::vector<Quat> smoothOrientations(const ZeroPhaseFilter& filter, const std::vector<Quat>& raw) {
  std::vector<Quat> smooth(raw.size());
  std::vector<double> part(raw.size());
  for (int c = 0; c < 4; ++c) {
    for (std::size_t i = 0; i < part.size(); ++i) part[i] = raw[i].coeffs()[c];
    const std::vector<double> y = filter.apply(part);
    for (std::size_t i = 0; i < part.size(); ++i) smooth[i].coeffs()[c] = y[i];
  }
  for (std::size_t i = 0; i < smooth.size(); ++i) {
    const auto& q = smooth[i].coeffs();
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    // A turn of half a revolution within a filter's width can cancel out: the unfiltered one is a rotation.
    if (length > 1e-3) {
      smooth[i].coeffs() = q / length;
    } else {
      smooth[i] = raw[i];
    }
  }
  return smooth;
}

MotionSegment filteredSegment(GridRun&& run, const ZeroPhaseFilter& filter, bool oriented) {
  MotionSegment segment;
  segment.first = run.first;
  segment.continues = run.continues;
  segment.raw = std::move(run.position);
  segment.filtered = smoothPositions(filter, segment.raw);
  if (oriented) segment.orientation = smoothOrientations(filter, run.orientation);
  segment.speed = speeds(segment.filtered);
  return segment;
}

}  // namespace

std::string motionFilterText(double cutoff) {
  return fmt::format(
      "the tracker's own samples, linear to 100 Hz; gaps of up to 1 s without samples bridged by cubics, longer ones "
      "split; Butterworth order 2 at {:g} Hz forward and backward, odd extension by 50, steady initial state, cut-off "
      "not corrected by 0.802; central differences",
      cutoff);
}

std::uint64_t Motion::points() const {
  std::uint64_t count = 0;
  for (const MotionSegment& segment : segments) count += segment.filtered.size();
  return count;
}

Motion filteredMotion(MotionSamples samples, double cutoff) {
  Motion motion;
  motion.mounted = !samples.coverage.mounted.empty();
  motion.interval = samples.rate.interval();
  motion.rate = samples.rate.hertz(samples.longestRate);
  motion.cutoff = cutoff;
  const double unitsPerSecond = samples.grid.unitsPerSecond();
  std::vector<GridRun> runs = bridged(std::move(samples.grid).takeRuns(), GapRule(motion.interval), unitsPerSecond);
  const ZeroPhaseFilter filter(cutoff, motionRate);
  TimeSpans lost = std::move(samples.coverage.lost);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i].position.size() >= ZeroPhaseFilter::shortest) {
      motion.segments.push_back(filteredSegment(std::move(runs[i]), filter, samples.oriented));
    } else if (runs[i].continues || (i + 1 < runs.size() && runs[i + 1].continues)) {
      lost.push_back({runs[i].begin.time / unitsPerSecond, runs[i].end.time / unitsPerSecond});
    }
  }
  motion.coverage = {std::move(samples.coverage.mounted), {}};
  motion.coverage.lost = intersection(normalized(std::move(lost)), motion.coverage.mounted);
  motion.movementSpeed = movementSpeedOf(motion.segments);
  return motion;
}

}  // namespace calot::analytics
