// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/instrument_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gui/render/loft.h"

namespace calot::gui {
namespace {

constexpr double mm = 1e-3;
constexpr double nominalRadius = 2.5 * mm;  // sizes below are those of a 5 mm instrument
constexpr int around = 20;                  // points of a ring

Quat aboutHinge(double angle) { return Quat(Eigen::AngleAxisd(angle, Vec3::UnitX())); }

Mesh mirrored(Mesh mesh) {  // the other jaw: y to -y
  for (Vec3& p : mesh.position) p.y() = -p.y();
  for (Vec3& n : mesh.normal) n.y() = -n.y();
  for (Index3& t : mesh.triangle) std::swap(t[1], t[2]);
  return mesh;
}

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

// One jaw from its hinge at z = 0 along z, its inner face at y = 0: tapered, rounded at the tip, toothed inside.
Mesh grasperJaw(double length, double scale) {
  std::vector<Ring> rings;
  const int steps = static_cast<int>(std::lround(length / (0.45 * mm * scale)));
  for (int i = 0; i <= steps; ++i) {
    const double u = static_cast<double>(i) / steps;
    const double z = u * length;
    const double toTip = (1.0 - u) * length;
    const double blunt = 1.8 * mm * scale;
    const double rounding =
        toTip < blunt ? std::sqrt(std::max(0.02, 1.0 - (1.0 - toTip / blunt) * (1.0 - toTip / blunt))) : 1.0;
    const double halfWidth = (2.05 - 0.75 * u) * mm * scale * rounding;
    const double thickness = (2.0 - 1.05 * u) * mm * scale * rounding;
    const double tooth = i % 2 == 0 && u > 0.2 ? 0.16 * mm * scale : 0.0;
    Ring ring = superellipse({0, 0, z}, halfWidth, thickness, 2.6, around);
    for (Vec3& p : ring)
      if (p.y() < 0.0) p.y() = tooth + 0.04 * p.y();
    rings.push_back(ring);
  }
  return loft(rings);
}

// A curved, pointed blade; side is +1 or -1: which side of the hinge plane it lies on.
Mesh scissorBlade(double length, double side, double scale) {
  std::vector<Ring> rings;
  constexpr int steps = 30;
  for (int i = 0; i <= steps; ++i) {
    const double u = static_cast<double>(i) / steps;
    const double height = (2.3 * (1.0 - u) + 0.35) * mm * scale * (u < 0.97 ? 1.0 : 0.5);
    const double thickness = (0.62 - 0.3 * u) * mm * scale;
    const double bend = 2.6 * mm * scale * u * u;
    Ring ring = superellipse({0, 0, u * length}, thickness, height, 2.8, 20);
    for (Vec3& p : ring) {
      if (p.y() < 0.0) p.y() *= 0.25;
      p.x() += side * 0.55 * mm * scale * (1.0 - 0.6 * u) + bend;
    }
    rings.push_back(ring);
  }
  return loft(rings);
}

// A bar that first leaves the axis and then runs parallel to it, its tip turned inward.
Mesh clipJaw(double length, double scale) {
  std::vector<Ring> rings;
  constexpr int steps = 36;
  for (int i = 0; i <= steps; ++i) {
    const double u = static_cast<double>(i) / steps;
    const double rise = std::min(1.0, u / 0.35);
    const double lift = 1.7 * mm * scale * rise * rise * (3.0 - 2.0 * rise);
    const double tip = u > 0.9 ? (u - 0.9) / 0.1 : 0.0;
    Ring ring = superellipse({0, 0, u * length}, (1.9 - 0.35 * u - 0.3 * tip) * mm * scale,
                             (0.95 - 0.2 * tip) * mm * scale, 3.5, around);
    for (Vec3& p : ring) p.y() += lift + 0.2 * mm * scale - 0.7 * mm * scale * tip * tip;
    rings.push_back(ring);
  }
  return loft(rings);
}

class Maker {
 public:
  explicit Maker(const InstrumentView& instrument)
      : scale_(instrument.radius / nominalRadius), jaw_(std::clamp(instrument.jaw, 0.0, 2.5)) {
    const Vec3 axis = instrument.pose.orientation.normalized() * Vec3::UnitZ();
    const double toPort = (instrument.pose.position - instrument.port).dot(axis);
    shaftStart_ = -std::max(toPort, 0.06) - 0.10;  // ten centimetres of it stand outside the port
  }

  std::vector<InstrumentPart> parts;

  void grasper() {
    const double length = 17.0 * mm * scale_;
    jawed(length, 9.0 * mm * scale_);
    addJaws(grasperJaw(length, scale_), length);
  }

  void scissors() {
    const double length = 15.0 * mm * scale_;
    jawed(length, 9.0 * mm * scale_);
    add(Appearance::steel, moved(scissorBlade(length, 1.0, scale_), aboutHinge(-0.5 * jaw_), Vec3(0, 0, -length)));
    add(Appearance::steel,
        moved(mirrored(scissorBlade(length, -1.0, scale_)), aboutHinge(0.5 * jaw_), Vec3(0, 0, -length)));
  }

  void clipApplier() {
    const double length = 16.0 * mm * scale_;
    jawed(length, 10.0 * mm * scale_);
    addJaws(clipJaw(length, scale_), length);
    // A loaded clip: a V whose legs lie in the jaws.
    const auto leg = [&](double z) { return std::sin(0.5 * jaw_) * z + 1.15 * mm * scale_; };
    const double front = length - 1.2 * mm * scale_, back = length - 8.5 * mm * scale_;
    std::vector<Vec3> path{{0, leg(front), front - length},
                           {0, leg(back + 1.5 * mm * scale_), back + 1.5 * mm * scale_ - length},
                           {0, 0.45 * leg(back), back - length},
                           {0, -0.45 * leg(back), back - length},
                           {0, -leg(back + 1.5 * mm * scale_), back + 1.5 * mm * scale_ - length},
                           {0, -leg(front), front - length}};
    add(Appearance::titanium, tube(path, 0.42 * mm * scale_, 14));
  }

  void hook() {
    const double sleeveEnd = -13.0 * mm * scale_;
    add(Appearance::insulation, barrel(shaftStart_, sleeveEnd, nominalRadius * scale_, 0.4 * mm * scale_));
    add(Appearance::ceramic,
        loft({superellipse({0, 0, sleeveEnd}, 2.0 * mm * scale_, 2.0 * mm * scale_, 2, around),
              superellipse({0, 0, sleeveEnd + 2.5 * mm * scale_}, 1.9 * mm * scale_, 1.9 * mm * scale_, 2, around),
              superellipse({0, 0, sleeveEnd + 3.6 * mm * scale_}, 1.0 * mm * scale_, 1.0 * mm * scale_, 2, around)}));
    // The L: along the axis, a short bend, then across; its heel is the tip of the frame.
    const double wire = 0.6 * mm * scale_, bend = 1.3 * mm * scale_, across = 4.6 * mm * scale_;
    std::vector<Vec3> path{{0, 0, sleeveEnd + 2.0 * mm * scale_}, {0, 0, -6.0 * mm * scale_}};
    constexpr int steps = 8;
    for (int i = 0; i <= steps; ++i) {
      const double angle = 0.5 * std::numbers::pi * i / steps;
      path.emplace_back(0, bend * (1.0 - std::cos(angle)), -wire - bend + bend * std::sin(angle));
    }
    path.emplace_back(0, across, -wire);
    add(Appearance::steel, tube(path, wire, 18));
  }

 private:
  void add(Appearance appearance, Mesh mesh) { parts.push_back({appearance, std::move(mesh)}); }

  // Common parts of all instruments with jaws.
  void jawed(double jawLength, double clevisLength) {
    const double hinge = -jawLength;
    const double sleeveEnd = hinge - clevisLength;
    add(Appearance::insulation, barrel(shaftStart_, sleeveEnd, nominalRadius * scale_, 0.4 * mm * scale_));
    add(Appearance::steel, clevis(sleeveEnd - 0.5 * mm * scale_, hinge, scale_));
    add(Appearance::steel, hingePin(hinge, scale_));
  }

  void addJaws(const Mesh& upper, double length) {
    add(Appearance::steel, moved(upper, aboutHinge(-0.5 * jaw_), Vec3(0, 0, -length)));
    add(Appearance::steel, moved(mirrored(upper), aboutHinge(0.5 * jaw_), Vec3(0, 0, -length)));
  }

  double scale_;
  double jaw_;
  double shaftStart_ = 0.0;
};

}  // namespace

std::vector<InstrumentPart> makeInstrument(const InstrumentView& instrument) {
  Maker maker(instrument);
  switch (instrument.kind) {
    case InstrumentKind::none:
      break;
    case InstrumentKind::grasper:
      maker.grasper();
      break;
    case InstrumentKind::hook:
      maker.hook();
      break;
    case InstrumentKind::clipApplier:
      maker.clipApplier();
      break;
    case InstrumentKind::scissors:
      maker.scissors();
      break;
  }
  return std::move(maker.parts);
}

}  // namespace calot::gui
