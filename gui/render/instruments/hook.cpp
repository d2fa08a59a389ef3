// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>

#include "gui/render/instruments/instrument_parts.h"

namespace calot::gui {

void drawing::hook(InstrumentParts& parts) {
  const double m = mm * parts.scale();
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

}  // namespace calot::gui
