// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/checkpoints/motion_track.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "analytics/checkpoints/motion.h"
#include "recorder/sources/tracked_motion.h"

namespace calot::analytics {
namespace {

/// Intervals over so many of the tracker's own hold a sample whose pose was equal to the one before, and so unseen.
constexpr double unseenIntervals = 1.5;

}  // namespace

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

/// The newest sample's pose stood for longer than a source holds one.
bool MotionTrack::rested() const { return seconds(vouched_ - sample_) > straightBridge; }

/// What the newest sample's pose vouches for beyond 0.1 s is rest, up to the end.
void MotionTrack::closeRest(SampleGrid& grid) const {
  if (!grid.runs().empty() && rested()) grid.extend(static_cast<double>(vouched_), position_, orientation_);
}

/// A held pose is no measurement: without rest, a pause begins at the newest sample.
MotionTrack::Pause MotionTrack::pauseUntil(std::int64_t tick) const {
  if (instrument_ == InstrumentKind::none) return {mountedAt_, tick, true};
  return {rested() ? vouched_ : sample_, tick, false};
}

void MotionTrack::unmount() {
  if (instrument_ != InstrumentKind::none) closeRest(grid_);
  if (mountedAt_ >= 0) {
    if (instrument_ == InstrumentKind::none || tick_ - vouched_ > 1) pauses_.push_back(pauseUntil(tick_));
    mounted_.push_back({seconds(mountedAt_), seconds(tick_)});
  }
  instrument_ = InstrumentKind::none;
  mountedAt_ = -1;
  vouched_ = sample_ = tick_;  // nothing more to close
}

void MotionTrack::begin(const InstrumentSample& sample, bool continues) {
  closeRest(grid_);
  grid_.begin(static_cast<double>(tick_), sample.position, sample.orientation, continues);
  interval_ = 1;
}

void MotionTrack::sampled(const InstrumentSample& sample) {
  if (tick_ - vouched_ > 1) {  // interrupted
    const std::int64_t from = rested() ? vouched_ : sample_;
    if (!rested()) rate_.add(seconds(tick_ - sample_));
    if (seconds(tick_ - from) > straightBridge) {
      begin(sample, true);
      return;
    }
    closeRest(grid_);
  } else if (seconds(tick_ - sample_) > straightBridge) {
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
    unmount();
    return;
  }
  if (mountedAt_ < 0) mountedAt_ = tick_;
  if (!sample.valid) return;
  const bool first = instrument_ == InstrumentKind::none;
  const bool same = sample.instrument == instrument_;
  if (first ? tick_ > mountedAt_ : tick_ - vouched_ > 1) pauses_.push_back(pauseUntil(tick_));
  const bool moved = sample.position != position_ || sample.orientation.coeffs() != orientation_.coeffs();
  if (!same) {
    begin(sample, false);
  } else if (seconds(tick_ - vouched_) > straightBridge) {
    sampled(sample);  // lost for longer than a source holds a pose: a sample, moved or not
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

MotionCoverage MotionTrack::coverage(double interval) const {
  MotionCoverage coverage{mounted_, {}};
  std::vector<Pause> pauses = pauses_;
  const std::int64_t end = tick_ + 1;
  if (mountedAt_ >= 0) {
    coverage.mounted.push_back({seconds(mountedAt_), seconds(end)});
    if (instrument_ == InstrumentKind::none || vouched_ < tick_) pauses.push_back(pauseUntil(end));
  }
  const GapRule rule(interval);
  for (const Pause& pause : pauses) {
    const double pauseSeconds = seconds(pause.to - pause.from);
    if (pause.atStart) {
      coverage.lost.push_back({seconds(pause.from), seconds(pause.to)});
    } else if (rule.isGap(pauseSeconds)) {
      coverage.lost.push_back({seconds(pause.to) - rule.lost(pauseSeconds), seconds(pause.to)});
    }
  }
  coverage.mounted = normalized(std::move(coverage.mounted));
  coverage.lost = normalized(std::move(coverage.lost));
  return coverage;
}

Motion MotionTrack::motion(double cutoff) const {
  MotionSamples samples{grid_, rate_, unseenIntervals * rate_.interval(), coverage(rate_.interval()), true};
  closeRest(samples.grid);
  return filteredMotion(std::move(samples), cutoff);
}

MotionTrack trackFor(const recorder::AttemptHeader& header) {
  // A kinematics file's rows were interpolated to ticks by its source; a device that plays one holds them.
  const recorder::Provenance& from = header.provenance;
  const bool interpolated = from.kind == recorder::OperatorKind::kinematics && from.device.empty();
  return MotionTrack(header.tickSeconds, interpolated ? recorder::kinematicsRowsPerSecond : 0.0);
}

std::array<Motion, handCount> motionOf(recorder::Recording& recording, double cutoff) {
  std::array<MotionTrack, handCount> track{trackFor(recording.header()), trackFor(recording.header())};
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    for (const TickSamples& tick : recording.step(n).samples) {
      for (std::size_t h = 0; h < track.size(); ++h) track[h].add(tick.hand[h]);
    }
  }
  return {track[0].motion(cutoff), track[1].motion(cutoff)};
}

}  // namespace calot::analytics
