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

void GridRun::append(const Vec3& p, const Quat& q) {
  double cosine = 1.0;
  if (!orientation.empty()) {
    const Quat& before = orientation.back();
    cosine = before.w() * q.w() + before.x() * q.x() + before.y() * q.y() + before.z() * q.z();
  }
  position.push_back(p);
  orientation.push_back(cosine < 0.0 ? Quat(-q.w(), -q.x(), -q.y(), -q.z()) : q);
}

double gridTime(std::int64_t k, double unitsPerSecond) { return static_cast<double>(k) * unitsPerSecond / motionRate; }

void SampleGrid::put(const Vec3& position, const Quat& orientation) {
  runs_.back().append(position, orientation);
  ++next_;
}

void SampleGrid::begin(double time, const Vec3& position, const Quat& orientation, bool continues) {
  const double slack = onThePoint * unitsPerSecond_ / motionRate;
  next_ = static_cast<std::int64_t>(std::floor(time * motionRate / unitsPerSecond_));
  while (gridTime(next_, unitsPerSecond_) < time - slack) ++next_;
  const TimedPose sample{time, position, unit(orientation)};
  runs_.push_back({next_, {}, {}, sample, sample, continues});
  if (gridTime(next_, unitsPerSecond_) <= time + slack) put(position, sample.orientation);
}

void SampleGrid::extend(double time, const Vec3& position, const Quat& orientation) {
  assert(!runs_.empty() && time > runs_.back().end.time);
  const TimedPose last = runs_.back().end;
  const Quat to = unit(orientation);
  const double slack = onThePoint * unitsPerSecond_ / motionRate;
  for (double at = gridTime(next_, unitsPerSecond_); at <= time + slack; at = gridTime(next_, unitsPerSecond_)) {
    if (at >= time - slack) {
      put(position, to);
    } else {
      const double s = (at - last.time) / (time - last.time);
      put(last.position + s * (position - last.position), recorder::interpolated(last.orientation, to, s));
    }
  }
  runs_.back().end = {time, position, to};
}

}  // namespace calot::analytics
