// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/instruments/jaw_space.h"

#include "sim/instruments/instrument_shape.h"
#include "sim/math/elementary.h"

namespace calot {

namespace {

/// Half-space normal.p <= offset.
struct HalfSpace {
  Vec3 normal;
  double offset;
};

std::array<HalfSpace, 6> sidesOf(const JawSpace& s) {
  return {HalfSpace{Vec3::UnitX(), s.halfWidth},
          {-Vec3::UnitX(), s.halfWidth},
          {Vec3(0.0, 1.0, -s.slope), -s.slope * s.hinge},
          {Vec3(0.0, -1.0, -s.slope), -s.slope * s.hinge},
          {Vec3::UnitZ(), s.front},
          {-Vec3::UnitZ(), -s.back}};
}

/// Sutherland and Hodgman (1974).
void clip(const HalfSpace& side, SmallPolygon& polygon) {
  SmallPolygon out;
  for (std::size_t k = 0; k < polygon.count; ++k) {
    const Vec3& p = polygon.corner[k];
    const Vec3& q = polygon.corner[(k + 1) % polygon.count];
    const double beyondP = side.normal.dot(p) - side.offset;
    const double beyondQ = side.normal.dot(q) - side.offset;
    if (beyondP <= 0.0 && out.count < SmallPolygon::capacity) out.corner[out.count++] = p;
    if ((beyondP <= 0.0) != (beyondQ <= 0.0) && out.count < SmallPolygon::capacity)
      out.corner[out.count++] = p + (beyondP / (beyondP - beyondQ)) * (q - p);
  }
  polygon = out;
}

}  // namespace

bool JawSpace::contains(const Vec3& p) const {
  for (const HalfSpace& side : sidesOf(*this)) {
    if (side.normal.dot(p) > side.offset) return false;
  }
  return true;
}

JawSpace jawSpace(const InstrumentDefinition& instrument, double shaftRadius, double depth, double beyond) {
  const double scale = shaftRadius / nominalRadius;
  const double half = 0.5 * instrument.jaw.opened;
  return {-instrument.jawLength * scale, sine(half) / cosine(half), 0.5 * instrument.jawWidth * scale, -depth, beyond};
}

SmallPolygon between(const JawSpace& space, const Vec3& a, const Vec3& b, const Vec3& c) {
  SmallPolygon polygon;
  polygon.corner[0] = a;
  polygon.corner[1] = b;
  polygon.corner[2] = c;
  polygon.count = 3;
  for (const HalfSpace& side : sidesOf(space)) {
    clip(side, polygon);
    if (polygon.count == 0) break;
  }
  return polygon;
}

}  // namespace calot
