// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "gui/render/instruments/instrument_parts.h"
#include "sim/instruments/instruments.h"

namespace calot::gui {
namespace {

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

}  // namespace

void drawing::grasper(InstrumentParts& parts) {
  const double length = instrument::grasper.jawLength * parts.scale();
  const Mesh jaw = grasperJaw(length, parts.scale());
  parts.addHinged(length, 9.0 * mm * parts.scale());
  parts.addJaws(jaw, mirrored(jaw), length);
}

}  // namespace calot::gui
