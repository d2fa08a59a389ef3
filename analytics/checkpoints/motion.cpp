// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

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

}  // namespace

std::string motionFilterText(double cutoff) {
  return fmt::format(
      "the tracker's own samples, linear to 100 Hz, gaps over 0.1 s split; Butterworth order 2 at {:g} Hz forward and "
      "backward, odd extension by 50, steady initial state, cut-off not corrected by 0.802; central differences",
      cutoff);
}

std::uint64_t Motion::points() const {
  std::uint64_t count = 0;
  for (const MotionSegment& segment : segments) count += segment.filtered.size();
  return count;
}

std::vector<MotionSegment> filteredSegments(std::vector<GridRun> runs, double cutoff, bool oriented) {
  const ZeroPhaseFilter filter(cutoff, motionRate);
  std::vector<MotionSegment> segments;
  for (GridRun& run : runs) {
    if (run.position.size() < ZeroPhaseFilter::shortest) continue;
    MotionSegment segment;
    segment.first = run.first;
    segment.raw = std::move(run.position);
    segment.filtered = smoothPositions(filter, segment.raw);
    if (oriented) segment.orientation = smoothOrientations(filter, run.orientation);
    segment.speed = speeds(segment.filtered);
    segments.push_back(std::move(segment));
  }
  return segments;
}

MotionTrack::MotionTrack(double tickSeconds, double sourceRate)
    : tickSeconds_(tickSeconds), rowsPerTick_(sourceRate * tickSeconds), grid_(1.0 / tickSeconds) {
  assert(tickSeconds > 0.0 && sourceRate >= 0.0);
}

bool MotionTrack::isDue() const {
  if (rowsPerTick_ <= 0.0 || tick_ == 0) return true;
  // Half a row's thousandth keeps rounding from moving a row by a tick.
  const double t = static_cast<double>(tick_);
  return std::floor(t * rowsPerTick_ + 5e-4) > std::floor((t - 1.0) * rowsPerTick_ + 5e-4);
}

void MotionTrack::begin(const InstrumentSample& sample) {
  closeRest(grid_);
  grid_.begin(static_cast<double>(tick_), sample.position, sample.orientation);
  interval_ = 1;
}

/// What the newest sample's pose vouches for beyond 0.1 s is rest, up to the end.
void MotionTrack::closeRest(SampleGrid& grid) const {
  if (!grid.runs().empty() && seconds(vouched_ - sample_) > maxBridge)
    grid.extend(static_cast<double>(vouched_), position_, orientation_);
}

void MotionTrack::sampled(const InstrumentSample& sample) {
  const bool interrupted = tick_ - vouched_ > 1;
  const bool rested = seconds(vouched_ - sample_) > maxBridge;
  if (interrupted) {
    const std::int64_t from = rested ? vouched_ : sample_;
    if (seconds(tick_ - from) > maxBridge) {
      begin(sample);
      return;
    }
    closeRest(grid_);
  } else if (seconds(tick_ - sample_) > maxBridge) {
    const std::int64_t until = std::max(tick_ - interval_, sample_ + 1);
    if (until < tick_) grid_.extend(static_cast<double>(until), position_, orientation_);
  } else {
    interval_ = tick_ - sample_;
    rate_.add(seconds(interval_));
  }
  grid_.extend(static_cast<double>(tick_), sample.position, sample.orientation);
}

void MotionTrack::add(const InstrumentSample& sample) {
  ++tick_;
  if (sample.instrument == InstrumentKind::none) {
    if (instrument_ != InstrumentKind::none) closeRest(grid_);
    instrument_ = InstrumentKind::none;
    vouched_ = sample_ = tick_;  // nothing more to close
    return;
  }
  ++mountedTicks_;
  if (!sample.valid) return;
  ++validTicks_;
  const bool same = sample.instrument == instrument_;
  const bool lost = same && seconds(tick_ - vouched_) > maxBridge;
  const bool moved = sample.position != position_ || sample.orientation.coeffs() != orientation_.coeffs();
  if (!same || lost) {
    begin(sample);
  } else if (!moved || !isDue()) {
    vouched_ = tick_;
    return;
  } else {
    sampled(sample);
  }
  instrument_ = sample.instrument;
  sample_ = vouched_ = tick_;
  position_ = sample.position;
  orientation_ = sample.orientation;
}

Motion MotionTrack::motion(double cutoff) const {
  Motion motion;
  motion.mounted = mountedTicks_ > 0;
  motion.mountedTicks = mountedTicks_;
  motion.validTicks = validTicks_;
  motion.rate = rate_.hertz();
  motion.cutoff = cutoff;
  SampleGrid grid = grid_;
  closeRest(grid);
  motion.segments = filteredSegments(std::move(grid).takeRuns(), cutoff);
  const double covered = static_cast<double>(motion.points()) / motionRate;
  motion.unmeasured = std::max(0.0, seconds(static_cast<std::int64_t>(mountedTicks_)) - covered);
  return motion;
}

}  // namespace calot::analytics
