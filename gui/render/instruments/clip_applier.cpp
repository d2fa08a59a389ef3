// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "gui/render/instruments/instrument_parts.h"
#include "sim/instruments/instruments.h"

namespace calot::gui {
namespace {

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

}  // namespace

void drawing::clipApplier(InstrumentParts& parts) {
  const double m = mm * parts.scale();
  const double length = instrument::clipApplier.jawLength * parts.scale();
  const Mesh jaw = clipJaw(length, parts.scale());
  parts.addHinged(length, 10.0 * m);
  parts.addJaws(jaw, mirrored(jaw), length);
  // A loaded clip: a V whose legs lie in the jaws.
  const auto leg = [&](double z) { return std::sin(0.5 * parts.jaw()) * z + 1.15 * m; };
  const double front = length - 1.2 * m, back = length - 8.5 * m;
  std::vector<Vec3> path{{0, leg(front), front - length},
                         {0, leg(back + 1.5 * m), back + 1.5 * m - length},
                         {0, 0.45 * leg(back), back - length},
                         {0, -0.45 * leg(back), back - length},
                         {0, -leg(back + 1.5 * m), back + 1.5 * m - length},
                         {0, -leg(front), front - length}};
  parts.add(Appearance::titanium, tube(path, 0.42 * m, 14));
}

}  // namespace calot::gui
