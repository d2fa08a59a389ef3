// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/motion.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "analytics/checkpoints/zero_phase_filter.h"

namespace calot::analytics {

MotionTrack::MotionTrack(double tickSeconds)
    : ticksPerPoint_(1.0 / (motionRate * tickSeconds)), tickSeconds_(tickSeconds) {
  assert(tickSeconds > 0.0);
}

double MotionTrack::tickOf(std::int64_t gridIndex) const { return static_cast<double>(gridIndex) * ticksPerPoint_; }

void MotionTrack::begin(const Vec3& position) {
  next_ = static_cast<std::int64_t>(std::floor(static_cast<double>(tick_) / ticksPerPoint_));
  while (tickOf(next_) < static_cast<double>(tick_)) ++next_;
  runs_.push_back({next_, {}});
  if (tickOf(next_) == static_cast<double>(tick_)) {
    runs_.back().points.push_back(position);
    ++next_;
  }
}

void MotionTrack::extend(const Vec3& position) {
  const double from = static_cast<double>(lastValid_), to = static_cast<double>(tick_);
  while (tickOf(next_) <= to) {
    const double t = (tickOf(next_) - from) / (to - from);
    runs_.back().points.push_back(t == 1.0 ? position : Vec3(lastPosition_ + t * (position - lastPosition_)));
    ++next_;
  }
}

void MotionTrack::add(const InstrumentSample& sample) {
  ++tick_;
  if (sample.instrument == InstrumentKind::none) {
    instrument_ = InstrumentKind::none;
    return;
  }
  ++mountedTicks_;
  if (!sample.valid) return;
  ++validTicks_;
  const bool sameMotion = !runs_.empty() && sample.instrument == instrument_ &&
                          static_cast<double>(tick_ - lastValid_) * tickSeconds_ <= longestBridge;
  if (sameMotion) {
    extend(sample.position);
  } else {
    begin(sample.position);
  }
  instrument_ = sample.instrument;
  lastValid_ = tick_;
  lastPosition_ = sample.position;
}

Motion MotionTrack::motion() const {
  Motion motion;
  motion.mounted = mountedTicks_ > 0;
  motion.mountedTicks = mountedTicks_;
  motion.validTicks = validTicks_;
  const ZeroPhaseFilter filter(motionCutoff, motionRate);
  double covered = 0.0;
  for (const Run& run : runs_) {
    if (run.points.size() < ZeroPhaseFilter::shortest) continue;
    MotionSegment segment{run.first, run.points, run.points};
    std::vector<double> axis(run.points.size());
    for (int a = 0; a < 3; ++a) {
      for (std::size_t i = 0; i < axis.size(); ++i) axis[i] = run.points[i][a];
      const std::vector<double> smooth = filter.apply(axis);
      for (std::size_t i = 0; i < axis.size(); ++i) segment.filtered[i][a] = smooth[i];
    }
    covered += static_cast<double>(run.points.size()) / motionRate;
    motion.segments.push_back(std::move(segment));
  }
  motion.unmeasured = std::max(0.0, static_cast<double>(mountedTicks_) * tickSeconds_ - covered);
  return motion;
}

}  // namespace calot::analytics
