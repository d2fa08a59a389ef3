// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/geometry/dwell.h"

#include <algorithm>
#include <cmath>

#include "sim/geometry/closest_point.h"

namespace calot {

namespace {

constexpr StepInterval never{1.0, 0.0};
constexpr StepInterval always{0.0, 1.0};

StepInterval both(const StepInterval& a, const StepInterval& b) {
  return {std::max(a.from, b.from), std::min(a.to, b.to)};
}

/// Union of two parts of one convex region.
StepInterval hull(const StepInterval& a, const StepInterval& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {std::min(a.from, b.from), std::max(a.to, b.to)};
}

/// When a + b t lies in [low, high].
StepInterval linearWithin(double a, double b, double low, double high) {
  if (b == 0.0) return a >= low && a <= high ? always : never;
  const double first = (low - a) / b;
  const double last = (high - a) / b;
  return both(always, {std::min(first, last), std::max(first, last)});
}

/// When |p + t d| <= radius.
StepInterval insideBall(const Vec3& p, const Vec3& d, double radius) {
  const double dd = d.squaredNorm();
  const double outside = p.squaredNorm() - radius * radius;
  if (!(dd > 0.0)) return outside <= 0.0 ? always : never;
  const double half = p.dot(d);
  const double discriminant = half * half - dd * outside;
  if (!(discriminant > 0.0)) return never;
  const double root = std::sqrt(discriminant);
  return both(always, {(-half - root) / dd, (-half + root) / dd});
}

}  // namespace

StepInterval insideCapsule(const Vec3& from, const Vec3& way, const Vec3& a, const Vec3& b, double radius) {
  const Vec3 p = from - a;
  const StepInterval start = insideBall(p, way, radius);
  const Vec3 axis = b - a;
  const double length2 = axis.squaredNorm();
  if (!(length2 > 0.0)) return start;
  const StepInterval ends = hull(start, insideBall(from - b, way, radius));
  const Vec3 acrossP = p - (p.dot(axis) / length2) * axis;
  const Vec3 acrossWay = way - (way.dot(axis) / length2) * axis;
  const StepInterval beside = linearWithin(p.dot(axis), way.dot(axis), 0.0, length2);
  return hull(ends, both(insideBall(acrossP, acrossWay, radius), beside));
}

StepInterval segmentsNear(const Vec3& s0, const Vec3& s1, const Vec3& c0, const Vec3& c1, const Vec3& way,
                          double radius) {
  const Vec3 origin = -0.5 * way;
  // Corners of the parallelogram: translations of the first segment that bring a pair of ends together.
  const Vec3 corner = c0 - s0;
  const Vec3 e = c1 - c0;
  const Vec3 f = s0 - s1;
  StepInterval near = insideCapsule(origin, way, corner, corner + e, radius);
  near = hull(near, insideCapsule(origin, way, corner + f, corner + f + e, radius));
  near = hull(near, insideCapsule(origin, way, corner, corner + f, radius));
  near = hull(near, insideCapsule(origin, way, corner + e, corner + e + f, radius));
  const Vec3 normal = e.cross(f);
  const double area2 = normal.squaredNorm();
  // Parallel segments: the sides are all of it.
  if (!(area2 > 1e-20 * e.squaredNorm() * f.squaredNorm())) return near;
  const double area = std::sqrt(area2);
  const Vec3 p = origin - corner;
  StepInterval face = linearWithin(p.dot(normal), way.dot(normal), -radius * area, radius * area);
  const Vec3 alongE = f.cross(normal) / area2;
  const Vec3 alongF = normal.cross(e) / area2;
  face = both(face, linearWithin(p.dot(alongE), way.dot(alongE), 0.0, 1.0));
  face = both(face, linearWithin(p.dot(alongF), way.dot(alongF), 0.0, 1.0));
  return hull(near, face);
}

StepInterval near(const MovingCapsule& capsule, const MovingPoint& point, double reach) {
  const Vec3 c0 = 0.5 * (capsule.before[0] + capsule.now[0]);
  const Vec3 c1 = 0.5 * (capsule.before[1] + capsule.now[1]);
  const Vec3 middle = 0.5 * (point.before + point.now);
  const double s = closestOnSegment(middle, c0, c1);
  const Vec3 carried = (1.0 - s) * (capsule.now[0] - capsule.before[0]) + s * (capsule.now[1] - capsule.before[1]);
  const Vec3 way = (point.now - point.before) - carried;
  return insideCapsule(middle - 0.5 * way, way, c0, c1, capsule.radius + reach);
}

StepInterval near(const MovingCapsule& capsule, const std::array<MovingPoint, 2>& segment, double reach) {
  const Vec3 c0 = 0.5 * (capsule.before[0] + capsule.now[0]);
  const Vec3 c1 = 0.5 * (capsule.before[1] + capsule.now[1]);
  const Vec3 s0 = 0.5 * (segment[0].before + segment[0].now);
  const Vec3 s1 = 0.5 * (segment[1].before + segment[1].now);
  const SegmentSegment nearest = closestSegments(s0, s1, c0, c1);
  const Vec3 carried =
      (1.0 - nearest.t) * (capsule.now[0] - capsule.before[0]) + nearest.t * (capsule.now[1] - capsule.before[1]);
  const Vec3 moved =
      (1.0 - nearest.s) * (segment[0].now - segment[0].before) + nearest.s * (segment[1].now - segment[1].before);
  return segmentsNear(s0, s1, c0, c1, moved - carried, capsule.radius + reach);
}

Box boundsOf(const MovingCapsule& capsule, double reach) {
  Box box;
  for (const Vec3& p : capsule.before) box.include(p);
  for (const Vec3& p : capsule.now) box.include(p);
  box.grow(capsule.radius + reach);
  return box;
}

void StepIntervals::add(const StepInterval& interval) {
  if (interval.empty() || count_ == capacity) return;
  std::size_t k = count_++;
  for (; k > 0 && interval_[k - 1].from > interval.from; --k) interval_[k] = interval_[k - 1];
  interval_[k] = interval;
}

double StepIntervals::length() const {
  double sum = 0.0;
  double covered = 0.0;
  for (std::size_t k = 0; k < count_; ++k) {
    const double from = std::max(interval_[k].from, covered);
    if (interval_[k].to > from) sum += interval_[k].to - from;
    covered = std::max(covered, interval_[k].to);
  }
  return sum;
}

}  // namespace calot
