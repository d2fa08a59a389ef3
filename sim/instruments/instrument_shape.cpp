// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/instruments/instrument_shape.h"

#include <algorithm>
#include <cmath>

#include "sim/math/elementary.h"

namespace calot {

InstrumentShape instrumentShape(InstrumentKind kind, double jaw, double shaftRadius, double length) {
  InstrumentShape shape;
  const InstrumentDefinition& definition = instrumentOf(kind);
  if (definition.shape == nullptr) return shape;
  ShapeBuilder builder(shape, jaw, shaftRadius, length);
  definition.shape(builder);
  builder.measure();
  return shape;
}

InstrumentShape placed(const InstrumentShape& shape, const Pose& pose) {
  InstrumentShape out = shape;
  const Mat3 rotation = pose.orientation.toRotationMatrix();
  for (std::size_t k = 0; k < out.count_; ++k) {
    out.capsule_[k].p0 = pose.position + rotation * shape.capsule_[k].p0;
    out.capsule_[k].p1 = pose.position + rotation * shape.capsule_[k].p1;
  }
  return out;
}

std::pair<Vec3, Vec3> graspLine(const InstrumentDefinition& instrument, double shaftRadius) {
  return {Vec3(0.0, 0.0, -instrument.teethLength * (shaftRadius / nominalRadius)), Vec3::Zero()};
}

namespace {

double clampedJaw(double jaw) { return jaw > 0.0 ? std::min(jaw, InstrumentShape::widestJaw) : 0.0; }

}  // namespace

ShapeBuilder::ShapeBuilder(InstrumentShape& shape, double jaw, double shaftRadius, double length)
    : shape_(shape),
      scale_(shaftRadius / nominalRadius),
      shaftRadius_(shaftRadius),
      length_(length),
      cosine_(cosine(0.5 * clampedJaw(jaw))),
      sine_(sine(0.5 * clampedJaw(jaw))) {}

void ShapeBuilder::add(const Vec3& p0, const Vec3& p1, double radius, Capsule::Part part) {
  shape_.capsule_[shape_.count_] = {p0, p1, radius, part, static_cast<std::uint8_t>(shape_.count_)};
  ++shape_.count_;
}

void ShapeBuilder::addJaws(const Vec3& p0, const Vec3& p1, double radius) {
  const auto opened = [&](const Vec3& p, double side) {
    return Vec3(p[0], side * (p[1] * cosine_ + p[2] * sine_), hinge_ + (p[2] * cosine_ - p[1] * sine_));
  };
  add(opened(p0, 1.0), opened(p1, 1.0), radius, Capsule::Part::upperJaw);
  add(opened(p0, -1.0), opened(p1, -1.0), radius, Capsule::Part::lowerJaw);
}

void ShapeBuilder::addFork(double sleeve) {
  add(Vec3(0.0, 0.0, sleeve), Vec3(0.0, 0.0, hinge_), 2.1 * millimetre(), Capsule::Part::neck);
}

void ShapeBuilder::addShaft(double sleeve) {
  // The round end of the shaft's capsule stands no further out than where it meets the neck.
  double from = sleeve - 1.4 * millimetre();
  for (std::size_t k = 0; k < InstrumentShape::maxPieces && from > -length_; ++k) {
    const double to =
        k + 1 == InstrumentShape::maxPieces ? -length_ : std::max(from - InstrumentShape::pieceLength, -length_);
    add(Vec3(0.0, 0.0, from), Vec3(0.0, 0.0, to), shaftRadius_, Capsule::Part::shaft);
    from = to;
  }
}

void ShapeBuilder::measure() {
  for (const Capsule& c : shape_.capsules()) {
    for (const Vec3& p : {c.p0, c.p1}) {
      shape_.lateralReach_ = std::max(shape_.lateralReach_, std::sqrt(p[0] * p[0] + p[1] * p[1]) + c.radius);
      if (c.part != Capsule::Part::upperJaw && c.part != Capsule::Part::lowerJaw) continue;
      const double z = p[2] - hinge_;
      shape_.jawReach_ = std::max(shape_.jawReach_, std::sqrt(p[1] * p[1] + z * z) + c.radius);
    }
  }
}

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

Quat alongAxis(const Vec3& axis, const Vec3& roll) {
  Vec3 x = roll - axis * axis.dot(roll);
  if (x.norm() < 1e-6) {
    // The direction of W that the axis is farthest from.
    const Vec3 size = axis.cwiseAbs();
    const int k = size[0] <= size[1] && size[0] <= size[2] ? 0 : (size[1] <= size[2] ? 1 : 2);
    x = Vec3::Unit(k) - axis * axis[k];
  }
  x /= x.norm();
  Mat3 r;
  r.col(0) = x;
  r.col(1) = axis.cross(x);
  r.col(2) = axis;
  Quat q(r);
  q.coeffs() /= q.coeffs().norm();
  return q;
}

Pose throughPort(const Vec3& port, const Vec3& tip, const Quat& orientation, const Vec3& previousAxis) {
  const Vec3 reach = tip - port;
  const double length = reach.norm();
  const Vec3 axis = length > 1e-6 ? Vec3(reach / length) : previousAxis;
  Pose pose;
  pose.position = length >= minInsertion ? tip : Vec3(port + minInsertion * axis);
  pose.orientation = alongAxis(axis, orientation.toRotationMatrix().col(0));
  return pose;
}

ToolRow toolRow(const Vec3& port, const Pose& tool, const Vec3& point, const Vec3& direction) {
  const Vec3 reach = tool.position - port;
  const double length = reach.norm();
  const Vec3 axis = reach / length;
  const Vec3 r = point - port;
  ToolRow row;
  row.head<3>() = r.cross(direction).cross(axis) / length + direction.dot(axis) * axis;
  row[3] = axis.dot((point - tool.position).cross(direction));
  return row;
}

double rollBetween(const Quat& from, const Quat& to) {
  const Mat3 r = to.toRotationMatrix();
  const Mat3 f = alongAxis(r.col(2), from.toRotationMatrix().col(0)).toRotationMatrix();
  return arctangent2(r.col(0).dot(f.col(1)), r.col(0).dot(f.col(0)));
}

Pose movedTool(const Vec3& port, const Pose& tool, const Vec3& displacement, double roll) {
  const Mat3 before = tool.orientation.toRotationMatrix();
  const Pose pose = throughPort(port, tool.position + displacement, tool.orientation, before.col(2));
  if (roll == 0.0) return pose;
  const Mat3 r = pose.orientation.toRotationMatrix();
  return {pose.position, alongAxis(r.col(2), cosine(roll) * r.col(0) + sine(roll) * r.col(1))};
}

}  // namespace calot
