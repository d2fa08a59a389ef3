// SPDX-License-Identifier: GPL-3.0-or-later
// Time for which moving bodies are near each other: exact intervals within a step, for straight relative motion.
//
// Time runs from 0 to 1 over a step. A region is a convex set grown by a radius, at rest; a point that moves through it
// in a straight line is inside for one interval, whose ends are roots of linear and quadratic equations. So shares of a
// step are exact whatever its length: n short steps add up to one long one.
#pragma once

#include <array>
#include <cstddef>

#include "sim/math/linear.h"

namespace calot {

/// Share of a step; none where `to <= from`.
struct StepInterval {
  double from = 0.0;
  double to = 0.0;

  [[nodiscard]] bool empty() const { return !(to > from); }
};

/// A capsule that moves during a step.
struct MovingCapsule {
  std::array<Vec3, 2> before{Vec3::Zero(), Vec3::Zero()};  ///< ends of its axis at the step's beginning (m)
  std::array<Vec3, 2> now{Vec3::Zero(), Vec3::Zero()};     ///< and at the end of the step
  double radius = 0.0;                                     ///< m
};

/// A point that moves during a step.
struct MovingPoint {
  Vec3 before = Vec3::Zero();  ///< at the step's beginning (m)
  Vec3 now = Vec3::Zero();     ///< and at its end
};

/// Interval in which a point that moves from `from` by `way` is within `radius` of segment a-b (a ball where a = b).
/// @pre radius >= 0
[[nodiscard]] StepInterval insideCapsule(const Vec3& from, const Vec3& way, const Vec3& a, const Vec3& b,
                                         double radius);

/// Interval in which segment s0-s1, moving by `way` relative to segment c0-c1, is within `radius` of it. Both as they
/// are in the middle of the step. (The vectors that bring a point of one segment to a point of the other are a
/// parallelogram: the origin moves through it, grown by `radius`.)
[[nodiscard]] StepInterval segmentsNear(const Vec3& s0, const Vec3& s1, const Vec3& c0, const Vec3& c1, const Vec3& way,
                                        double radius);

/// Interval in which a point is within `reach` of a capsule's surface. The capsule keeps the shape of mid-step and
/// moves like its part that is nearest to the point then: exact for translations, of second order in the angle that it
/// turns.
[[nodiscard]] StepInterval near(const MovingCapsule& capsule, const MovingPoint& point, double reach);

/// The same of a segment.
[[nodiscard]] StepInterval near(const MovingCapsule& capsule, const std::array<MovingPoint, 2>& segment, double reach);

/// Contains all places that are within `reach` of the capsule during the step.
[[nodiscard]] Box boundsOf(const MovingCapsule& capsule, double reach);

/// Length of the union of a few intervals.
class StepIntervals {
 public:
  static constexpr std::size_t capacity = 8;

  /// Empty intervals are ignored, and any after the first `capacity`.
  void add(const StepInterval& interval);
  [[nodiscard]] bool empty() const { return count_ == 0; }
  /// In [0, 1].
  [[nodiscard]] double length() const;

 private:
  std::array<StepInterval, capacity> interval_{};  ///< by their beginnings
  std::size_t count_ = 0;
};

}  // namespace calot
