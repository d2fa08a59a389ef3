// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/instruments/instrument_shape.h"

#include <algorithm>
#include <cmath>

#include "sim/math/elementary.h"

namespace calot {

namespace {

constexpr double mm = 1e-3;
constexpr double nominalRadius = 2.5 * mm;  // sizes below are those of a 5 mm instrument

constexpr double grasperJaw = 17.0 * mm;
constexpr double scissorBlade = 15.0 * mm;
constexpr double clipJaw = 16.0 * mm;

/// Not a number counts as closed.
double clampedJaw(double jaw) { return jaw > 0.0 ? std::min(jaw, InstrumentShape::widestJaw) : 0.0; }

}  // namespace

void InstrumentShape::add(const Vec3& p0, const Vec3& p1, double radius, Capsule::Part part) {
  capsule_[count_] = {p0, p1, radius, part, static_cast<std::uint8_t>(count_)};
  ++count_;
}

/// A part of both jaws, given for the upper one when closed, from the hinge's line: x along it, y across, z to the tip.
void InstrumentShape::addJaw(const Vec3& p0, const Vec3& p1, double radius, double hinge, double cosine_,
                             double sine_) {
  const auto opened = [&](const Vec3& p, double side) {
    return Vec3(p[0], side * (p[1] * cosine_ + p[2] * sine_), hinge + (p[2] * cosine_ - p[1] * sine_));
  };
  add(opened(p0, 1.0), opened(p1, 1.0), radius, Capsule::Part::upperJaw);
  add(opened(p0, -1.0), opened(p1, -1.0), radius, Capsule::Part::lowerJaw);
}

/// Pieces from the working end towards the port.
void InstrumentShape::addShaft(double end, double length, double radius) {
  double from = end;
  for (std::size_t k = 0; k < mostPieces && from > -length; ++k) {
    const double to = k + 1 == mostPieces ? -length : std::max(from - pieceLength, -length);
    add(Vec3(0.0, 0.0, from), Vec3(0.0, 0.0, to), radius, Capsule::Part::shaft);
    from = to;
  }
}

void InstrumentShape::measure(double hinge) {
  for (const Capsule& c : capsules()) {
    for (const Vec3& p : {c.p0, c.p1}) {
      lateralReach_ = std::max(lateralReach_, std::sqrt(p[0] * p[0] + p[1] * p[1]) + c.radius);
      if (c.part != Capsule::Part::upperJaw && c.part != Capsule::Part::lowerJaw) continue;
      const double z = p[2] - hinge;
      jawReach_ = std::max(jawReach_, std::sqrt(p[1] * p[1] + z * z) + c.radius);
    }
  }
}

InstrumentShape instrumentShape(InstrumentKind kind, double jaw, double shaftRadius, double length) {
  InstrumentShape shape;
  if (kind == InstrumentKind::none) return shape;
  const double s = shaftRadius / nominalRadius;
  const double m = mm * s;
  const double c = cosine(0.5 * clampedJaw(jaw));
  const double n = sine(0.5 * clampedJaw(jaw));
  double hinge = 0.0;
  double sleeve = 0.0;  // z where the shaft's full radius ends
  switch (kind) {
    case InstrumentKind::none:
      break;
    case InstrumentKind::grasper:
      // Each jaw: two bars side by side that come together towards the tip.
      hinge = -grasperJaw * s;
      for (const double side : {-1.0, 1.0}) {
        shape.addJaw(Vec3(side * 1.2 * m, 1.15 * m, 0.5 * m), Vec3(side * 0.55 * m, 0.5 * m, grasperJaw * s - 0.75 * m),
                     0.75 * m, hinge, c, n);
      }
      sleeve = hinge - 9.0 * m;
      break;
    case InstrumentKind::clipApplier:
      // A bar that first leaves the axis and then runs along it, its end turned inward.
      hinge = -clipJaw * s;
      shape.addJaw(Vec3(0.0, 0.3 * m, 0.0), Vec3(0.0, 1.9 * m, 0.35 * clipJaw * s), 1.1 * m, hinge, c, n);
      for (const double side : {-1.0, 1.0}) {
        shape.addJaw(Vec3(side * 0.8 * m, 1.9 * m, 0.35 * clipJaw * s),
                     Vec3(side * 0.65 * m, 1.6 * m, clipJaw * s - 0.95 * m), 0.95 * m, hinge, c, n);
      }
      sleeve = hinge - 10.0 * m;
      break;
    case InstrumentKind::scissors:
      // A pointed blade, curved along the hinge's line.
      hinge = -scissorBlade * s;
      shape.addJaw(Vec3(0.0, 0.9 * m, 0.5 * m), Vec3(0.7 * m, 0.6 * m, 0.5 * scissorBlade * s), 0.9 * m, hinge, c, n);
      shape.addJaw(Vec3(0.7 * m, 0.6 * m, 0.5 * scissorBlade * s), Vec3(2.5 * m, 0.4 * m, scissorBlade * s - 0.5 * m),
                   0.5 * m, hinge, c, n);
      sleeve = hinge - 9.0 * m;
      break;
    case InstrumentKind::hook: {
      // The L: along the axis, a short bend in two chords, then across; its heel is the tip of the frame.
      const double wire = 0.6 * m;
      const Vec3 path[] = {Vec3(0.0, 0.0, -10.0 * m), Vec3(0.0, 0.0, -1.9 * m), Vec3(0.0, 0.381 * m, -0.981 * m),
                           Vec3(0.0, 1.3 * m, -wire), Vec3(0.0, 4.6 * m, -wire)};
      for (std::size_t k = 0; k < 4; ++k) shape.add(path[k], path[k + 1], wire, Capsule::Part::hook);
      sleeve = -13.0 * m;
      shape.add(Vec3(0.0, 0.0, sleeve), Vec3(0.0, 0.0, -11.3 * m), 1.9 * m, Capsule::Part::neck);
      break;
    }
  }
  if (kind != InstrumentKind::hook) {
    // The fork that holds the hinge reaches a little past it.
    shape.add(Vec3(0.0, 0.0, sleeve), Vec3(0.0, 0.0, hinge), 2.1 * m, Capsule::Part::neck);
  }
  // The round end of the shaft's capsule stands no further out than where it meets the neck.
  shape.addShaft(sleeve - 1.4 * m, length, shaftRadius);
  shape.measure(hinge);
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

GraspRegion graspRegion(double jaw, double shaftRadius) {
  const double s = shaftRadius / nominalRadius;
  const double half = 0.5 * std::min(clampedJaw(jaw), 2.0);
  GraspRegion region;
  region.hinge = -grasperJaw * s;
  region.from = -0.8 * grasperJaw * s;
  region.to = 0.0;
  region.halfWidth = 1.35 * mm * s;
  region.slope = sine(half) / cosine(half);
  region.slack = 0.5 * mm;
  return region;
}

}  // namespace calot
