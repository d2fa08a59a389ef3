// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/instrument_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sim/instruments/instruments.h"

namespace calot::gui {

namespace {

constexpr double mm = 1e-3;                 // m
constexpr int around = 20;                  // points of a ring
constexpr double nominalRadius = 2.5 * mm;  // sizes of drawings are those of 5 mm instruments

Quat aboutHinge(double angle) { return Quat(Eigen::AngleAxisd(angle, Vec3::UnitX())); }

// Cylinder along z with bevelled ends.
Mesh barrel(double from, double to, double radius, double bevel) {
  return loft({superellipse({0, 0, from}, radius - bevel, radius - bevel, 2, around),
               superellipse({0, 0, from + bevel}, radius, radius, 2, around),
               superellipse({0, 0, to - bevel}, radius, radius, 2, around),
               superellipse({0, 0, to}, radius - bevel, radius - bevel, 2, around)});
}

/// Skin over steps + 1 rings. @param ring of a share, 0 to 1
template <class RingAt>
Mesh swept(int steps, RingAt ring) {
  std::vector<Ring> rings;
  for (int i = 0; i <= steps; ++i) rings.push_back(ring(static_cast<double>(i) / steps));
  return loft(rings);
}

// From a round shaft to the flat fork that holds the hinge.
Mesh clevis(double from, double hinge, double scale) {
  return swept(12, [&](double u) {
    const double narrow = u * u * (3.0 - 2.0 * u);
    return superellipse({0, 0, from + u * (hinge + 1.4 * mm * scale - from)}, (2.3 - 0.2 * narrow) * mm * scale,
                        (2.3 - 1.0 * narrow) * mm * scale, 2.0 + 1.5 * narrow, around);
  });
}

Mesh hingePin(double hinge, double scale) {
  return tube({Vec3(-2.2 * mm * scale, 0, hinge), Vec3(2.2 * mm * scale, 0, hinge)}, 0.75 * mm * scale, 16);
}

/// The other jaw: y to -y.
Mesh mirrored(Mesh mesh) {
  for (Vec3& p : mesh.position) p.y() = -p.y();
  for (Vec3& n : mesh.normal) n.y() = -n.y();
  for (Index3& t : mesh.triangle) std::swap(t[1], t[2]);
  return mesh;
}

/// The parts of one instrument, as they are drawn. A drawing multiplies the sizes of a 5 mm instrument with `scale`.
struct InstrumentParts {
  double scale, jaw;  ///< jaw: opening angle (rad)
  double shaftStart;  ///< z (m)
  std::vector<InstrumentPart> list = {};

  explicit InstrumentParts(const InstrumentView& instrument)
      : scale(instrument.radius / nominalRadius), jaw(std::clamp(instrument.jaw, 0.0, 2.5)) {
    const Vec3 axis = instrument.pose.orientation.normalized() * Vec3::UnitZ();
    const double toPort = (instrument.pose.position - instrument.port).dot(axis);
    shaftStart = -std::max(toPort, 0.06) - 0.10;  // ten centimetres of it stand outside the port
  }

  void add(Appearance appearance, Mesh mesh) { list.push_back({appearance, std::move(mesh)}); }

  /// The insulated shaft, from outside the port to `end` (z).
  void addShaft(double end) {
    add(Appearance::insulation, barrel(shaftStart, end, nominalRadius * scale, 0.4 * mm * scale));
  }

  /// Shaft, fork and pin, and both jaws, opened. @param upper, lower from the hinge at z = 0 along z, inner faces at
  /// y = 0 when closed @param jawLength from the hinge to the tips @param forkLength from the shaft's end to the hinge
  void addJaws(const Mesh& upper, const Mesh& lower, double jawLength, double forkLength) {
    const double hinge = -jawLength;
    const double sleeveEnd = hinge - forkLength;
    addShaft(sleeveEnd);
    add(Appearance::steel, clevis(sleeveEnd - 0.5 * mm * scale, hinge, scale));
    add(Appearance::steel, hingePin(hinge, scale));
    add(Appearance::steel, moved(upper, aboutHinge(-0.5 * jaw), Vec3(0, 0, hinge)));
    add(Appearance::steel, moved(lower, aboutHinge(0.5 * jaw), Vec3(0, 0, hinge)));
  }
};

// A bar that first leaves the axis and then runs parallel to it, its tip turned inward.
Mesh clipJaw(double length, double scale) {
  return swept(36, [&](double u) {
    const double rise = std::min(1.0, u / 0.35);
    const double lift = 1.7 * mm * scale * rise * rise * (3.0 - 2.0 * rise);
    const double tip = u > 0.9 ? (u - 0.9) / 0.1 : 0.0;
    Ring ring = superellipse({0, 0, u * length}, (1.9 - 0.35 * u - 0.3 * tip) * mm * scale,
                             (0.95 - 0.2 * tip) * mm * scale, 3.5, around);
    for (Vec3& p : ring) p.y() += lift + 0.2 * mm * scale - 0.7 * mm * scale * tip * tip;
    return ring;
  });
}

namespace drawing {

void clipApplier(InstrumentParts& parts) {
  const double m = mm * parts.scale;
  const double length = instrument::clipApplier.jawLength * parts.scale;
  const Mesh jaw = clipJaw(length, parts.scale);
  parts.addJaws(jaw, mirrored(jaw), length, 10.0 * m);
  // A loaded clip: a V whose legs lie in the jaws.
  const auto leg = [&](double z) { return std::sin(0.5 * parts.jaw) * z + 1.15 * m; };
  const double front = length - 1.2 * m, back = length - 8.5 * m;
  std::vector<Vec3> path{{0, leg(front), front - length},
                         {0, leg(back + 1.5 * m), back + 1.5 * m - length},
                         {0, 0.45 * leg(back), back - length},
                         {0, -0.45 * leg(back), back - length},
                         {0, -leg(back + 1.5 * m), back + 1.5 * m - length},
                         {0, -leg(front), front - length}};
  parts.add(Appearance::titanium, tube(path, 0.42 * m, 14));
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

void grasper(InstrumentParts& parts) {
  const double length = instrument::grasper.jawLength * parts.scale;
  const Mesh jaw = grasperJaw(length, parts.scale);
  parts.addJaws(jaw, mirrored(jaw), length, 9.0 * mm * parts.scale);
}

void hook(InstrumentParts& parts) {
  const double m = mm * parts.scale;
  const double sleeveEnd = -13.0 * m;
  parts.addShaft(sleeveEnd);
  parts.add(Appearance::ceramic, loft({superellipse({0, 0, sleeveEnd}, 2.0 * m, 2.0 * m, 2, around),
                                       superellipse({0, 0, sleeveEnd + 2.5 * m}, 1.9 * m, 1.9 * m, 2, around),
                                       superellipse({0, 0, sleeveEnd + 3.6 * m}, 1.0 * m, 1.0 * m, 2, around)}));
  // The L: along the axis, a short bend, then across; its heel is the tip of the frame.
  const double wire = 0.6 * m, bend = 1.3 * m, across = 4.6 * m;
  std::vector<Vec3> path{{0, 0, sleeveEnd + 2.0 * m}, {0, 0, -6.0 * m}};
  constexpr int steps = 8;
  for (int i = 0; i <= steps; ++i) {
    const double angle = 0.5 * std::numbers::pi * i / steps;
    path.emplace_back(0, bend * (1.0 - std::cos(angle)), -wire - bend + bend * std::sin(angle));
  }
  path.emplace_back(0, across, -wire);
  parts.add(Appearance::steel, tube(path, wire, 18));
}

void probe(InstrumentParts& parts) {
  const double radius = 2.5 * mm * parts.scale;
  const double shaft = -4.0 * radius;
  parts.addShaft(shaft);
  std::vector<Ring> rings{superellipse({0, 0, shaft}, radius, radius, 2, around)};
  constexpr int steps = 10;
  for (int i = 0; i <= steps; ++i) {
    const double angle = 0.49 * std::numbers::pi * i / steps;
    const double r = radius * std::cos(angle);
    rings.push_back(superellipse({0, 0, radius * (std::sin(angle) - 1.0)}, r, r, 2, around));
  }
  parts.add(Appearance::steel, loft(rings));
}

// A curved, pointed blade; side is +1 or -1: which side of the hinge plane it lies on.
Mesh scissorBlade(double length, double side, double scale) {
  return swept(30, [&](double u) {
    const double height = (2.3 * (1.0 - u) + 0.35) * mm * scale * (u < 0.97 ? 1.0 : 0.5);
    const double thickness = (0.62 - 0.3 * u) * mm * scale;
    const double bend = 2.6 * mm * scale * u * u;
    Ring ring = superellipse({0, 0, u * length}, thickness, height, 2.8, 20);
    for (Vec3& p : ring) {
      if (p.y() < 0.0) p.y() *= 0.25;
      p.x() += side * 0.55 * mm * scale * (1.0 - 0.6 * u) + bend;
    }
    return ring;
  });
}

void scissors(InstrumentParts& parts) {
  const double length = instrument::scissors.jawLength * parts.scale;
  parts.addJaws(scissorBlade(length, 1.0, parts.scale), mirrored(scissorBlade(length, -1.0, parts.scale)), length,
                9.0 * mm * parts.scale);
}

}  // namespace drawing
}  // namespace

std::vector<InstrumentPart> makeInstrument(const InstrumentView& instrument) {
  InstrumentParts parts(instrument);
  switch (instrument.kind) {
    case InstrumentKind::none:
      break;
#define CALOT_DRAWN(name, number) \
  case InstrumentKind::name:      \
    drawing::name(parts);         \
    break;
      CALOT_INSTRUMENTS(CALOT_DRAWN)
#undef CALOT_DRAWN
  }
  return std::move(parts.list);
}

Mesh makeClip(const ClipView& clip) {
  constexpr int around = 12, bend = 10, straight = 5;
  const double thickness = 0.5 * clip.width;
  // Distance of a leg's centre line from the vessel's. Legs slightly penetrate the wall, so that no surfaces coincide.
  const double offset = 0.75 * clip.halfGap + 0.5 * thickness;
  const double loop = std::max(1.25 * offset, thickness);  // radius of the crotch
  const double tip = 0.5 * clip.legs, crotch = -0.5 * clip.legs + loop;

  std::vector<Vec3> path;
  path.reserve(2 * straight + bend + 1);             // from one leg's tip around the crotch to the other's
  const auto leg = [&](double side, double share) {  // share 0 at the tip, 1 where the crotch begins
    const double open = share * share * (3.0 - 2.0 * share);
    return Vec3(side * (offset + (loop - offset) * open * open), tip + share * (crotch - tip), 0.0);
  };
  for (int i = 0; i < straight; ++i) path.push_back(leg(1.0, static_cast<double>(i) / straight));
  for (int i = 0; i <= bend; ++i) {
    const double angle = std::numbers::pi * i / bend;
    path.emplace_back(loop * std::cos(angle), crotch - loop * std::sin(angle), 0.0);
  }
  for (int i = straight - 1; i >= 0; --i) path.push_back(leg(-1.0, static_cast<double>(i) / straight));

  std::vector<Ring> rings;
  const Ring section = superellipse(Vec3::Zero(), 0.5 * thickness, 0.5 * clip.width, 3.0, around);
  const std::size_t last = path.size() - 1;
  const auto ringAt = [&](const Vec3& centre, const Vec3& along, double size) {
    const Vec3 side = Vec3::UnitZ().cross(along);
    Ring ring;
    for (const Vec3& p : section) ring.push_back(centre + size * (p.x() * side + p.y() * Vec3::UnitZ()));
    rings.push_back(ring);
  };
  for (std::size_t i = 0; i <= last; ++i) {
    const Vec3 along = (path[std::min(i + 1, last)] - path[i > 0 ? i - 1 : 0]).normalized();
    const double round = 0.3 * thickness;  // of the tips' edges
    if (i == 0) ringAt(path[i] - round * along, along, 0.75);
    ringAt(path[i], along, 1.0);
    if (i == last) ringAt(path[i] + round * along, along, 0.75);
  }
  return loft(rings);
}

}  // namespace calot::gui
