// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/instruments/instrument_parts.h"
#include "sim/instruments/instruments.h"

namespace calot::gui {
namespace {

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

}  // namespace

void drawing::scissors(InstrumentParts& parts) {
  const double length = instrument::scissors.jawLength * parts.scale();
  parts.addHinged(length, 9.0 * mm * parts.scale());
  parts.addJaws(scissorBlade(length, 1.0, parts.scale()), mirrored(scissorBlade(length, -1.0, parts.scale())), length);
}

}  // namespace calot::gui
