// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/instruments/instrument_parts.h"

#include <algorithm>
#include <utility>

namespace calot::gui {
namespace {

constexpr double nominalRadius = 2.5 * mm;  // sizes of drawings are those of 5 mm instruments

Quat aboutHinge(double angle) { return Quat(Eigen::AngleAxisd(angle, Vec3::UnitX())); }

// Cylinder along z with bevelled ends.
Mesh barrel(double from, double to, double radius, double bevel) {
  return loft({superellipse({0, 0, from}, radius - bevel, radius - bevel, 2, around),
               superellipse({0, 0, from + bevel}, radius, radius, 2, around),
               superellipse({0, 0, to - bevel}, radius, radius, 2, around),
               superellipse({0, 0, to}, radius - bevel, radius - bevel, 2, around)});
}

// From a round shaft to the flat fork that holds the hinge.
Mesh clevis(double from, double hinge, double scale) {
  std::vector<Ring> rings;
  constexpr int steps = 12;
  for (int i = 0; i <= steps; ++i) {
    const double u = static_cast<double>(i) / steps;
    const double narrow = u * u * (3.0 - 2.0 * u);
    rings.push_back(superellipse({0, 0, from + u * (hinge + 1.4 * mm * scale - from)},
                                 (2.3 - 0.2 * narrow) * mm * scale, (2.3 - 1.0 * narrow) * mm * scale,
                                 2.0 + 1.5 * narrow, around));
  }
  return loft(rings);
}

Mesh hingePin(double hinge, double scale) {
  return tube({Vec3(-2.2 * mm * scale, 0, hinge), Vec3(2.2 * mm * scale, 0, hinge)}, 0.75 * mm * scale, 16);
}

}  // namespace

Mesh mirrored(Mesh mesh) {
  for (Vec3& p : mesh.position) p.y() = -p.y();
  for (Vec3& n : mesh.normal) n.y() = -n.y();
  for (Index3& t : mesh.triangle) std::swap(t[1], t[2]);
  return mesh;
}

InstrumentParts::InstrumentParts(const InstrumentView& instrument)
    : scale_(instrument.radius / nominalRadius), jaw_(std::clamp(instrument.jaw, 0.0, 2.5)) {
  const Vec3 axis = instrument.pose.orientation.normalized() * Vec3::UnitZ();
  const double toPort = (instrument.pose.position - instrument.port).dot(axis);
  shaftStart_ = -std::max(toPort, 0.06) - 0.10;  // ten centimetres of it stand outside the port
}

void InstrumentParts::add(Appearance appearance, Mesh mesh) { parts_.push_back({appearance, std::move(mesh)}); }

void InstrumentParts::addShaft(double end) {
  add(Appearance::insulation, barrel(shaftStart_, end, nominalRadius * scale_, 0.4 * mm * scale_));
}

void InstrumentParts::addHinged(double jawLength, double forkLength) {
  const double hinge = -jawLength;
  const double sleeveEnd = hinge - forkLength;
  addShaft(sleeveEnd);
  add(Appearance::steel, clevis(sleeveEnd - 0.5 * mm * scale_, hinge, scale_));
  add(Appearance::steel, hingePin(hinge, scale_));
}

void InstrumentParts::addJaws(const Mesh& upper, const Mesh& lower, double jawLength) {
  add(Appearance::steel, moved(upper, aboutHinge(-0.5 * jaw_), Vec3(0, 0, -jawLength)));
  add(Appearance::steel, moved(lower, aboutHinge(0.5 * jaw_), Vec3(0, 0, -jawLength)));
}

}  // namespace calot::gui
