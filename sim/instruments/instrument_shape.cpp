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

}  // namespace calot
