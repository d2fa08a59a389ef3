// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>
#include <vector>

#include "gui/render/instruments/instrument_parts.h"

namespace calot::gui {

void drawing::probe(InstrumentParts& parts) {
  const double radius = 2.5 * mm * parts.scale();
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

}  // namespace calot::gui
