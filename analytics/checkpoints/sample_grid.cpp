// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/sample_grid.h"

#include <cassert>
#include <cmath>

#include "recorder/sources/pointing.h"

namespace calot::analytics {
namespace {

/// Share of a grid interval within which a sample counts as on the point: times in seconds are rounded.
constexpr double onThePoint = 1e-6;

Quat unit(const Quat& q) {
  const double length = std::sqrt(q.w() * q.w() + q.x() * q.x() + q.y() * q.y() + q.z() * q.z());
  if (!(length > 0.0)) return Quat::Identity();  // a recording of a stranger
  return {q.w() / length, q.x() / length, q.y() / length, q.z() / length};
}

}  // namespace

void SampleGrid::put(const Vec3& position, const Quat& orientation) {
  GridRun& run = runs_.back();
  Quat q = orientation;
  if (!run.orientation.empty()) {
    const Quat& before = run.orientation.back();
    const double cosine = before.w() * q.w() + before.x() * q.x() + before.y() * q.y() + before.z() * q.z();
    if (cosine < 0.0) q = Quat(-q.w(), -q.x(), -q.y(), -q.z());
  }
  run.position.push_back(position);
  run.orientation.push_back(q);
  ++next_;
}

void SampleGrid::begin(double time, const Vec3& position, const Quat& orientation) {
  const double slack = onThePoint * unitsPerSecond_ / motionRate;
  next_ = static_cast<std::int64_t>(std::floor(time * motionRate / unitsPerSecond_));
  while (timeOf(next_) < time - slack) ++next_;
  lastTime_ = time;
  lastPosition_ = position;
  lastOrientation_ = unit(orientation);
  runs_.push_back({next_, {}, {}});
  if (timeOf(next_) <= time + slack) put(lastPosition_, lastOrientation_);
}

void SampleGrid::extend(double time, const Vec3& position, const Quat& orientation) {
  assert(!runs_.empty() && time > lastTime_);
  const Quat to = unit(orientation);
  const double slack = onThePoint * unitsPerSecond_ / motionRate;
  while (timeOf(next_) <= time + slack) {
    const double at = timeOf(next_);
    if (at >= time - slack) {
      put(position, to);
    } else {
      const double s = (at - lastTime_) / (time - lastTime_);
      put(lastPosition_ + s * (position - lastPosition_), recorder::interpolated(lastOrientation_, to, s));
    }
  }
  lastTime_ = time;
  lastPosition_ = position;
  lastOrientation_ = to;
}

}  // namespace calot::analytics
