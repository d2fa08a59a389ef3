// SPDX-License-Identifier: GPL-3.0-or-later
// The space between a pair of jaws: what they take when they close.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "sim/instruments/instruments.h"

namespace calot {

/// In I: a wedge that opens from the hinge's line at half the angle at which the jaws count as open, as wide as the
/// jaws, between two planes across the shaft:
///   |x| <= halfWidth,   |y| <= slope (z - hinge),   back <= z <= front.
struct JawSpace {
  double hinge = 0.0;      ///< z of the hinge's line (m)
  double slope = 0.0;      ///< tangent of half the angle
  double halfWidth = 0.0;  ///< m
  double back = 0.0;       ///< m
  double front = 0.0;      ///< m

  [[nodiscard]] bool contains(const Vec3& p) const;
};

/// @param depth from the tips backwards (m) @param beyond the tips (m) @param shaftRadius m. @pre it has jaws
JawSpace jawSpace(const InstrumentDefinition& instrument, double shaftRadius, double depth, double beyond);

/// A convex polygon of few corners.
struct SmallPolygon {
  static constexpr std::size_t capacity = 12;
  std::array<Vec3, capacity> corner;
  std::size_t count = 0;
};

/// The part of triangle abc (in I) that lies between the jaws; a segment is a triangle with two equal corners. May be
/// empty.
SmallPolygon between(const JawSpace& space, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace calot
