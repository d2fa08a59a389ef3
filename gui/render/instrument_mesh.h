// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gui/render/draw_list.h"

namespace calot::gui {

struct InstrumentPart {
  Appearance appearance = Appearance::steel;
  Mesh mesh;  ///< in the instrument's frame I: origin at the tip, z along the shaft towards it, x along the jaws' hinge
              ///< (m)
};

/// Shaft from beyond the port to the tip, and what the instrument carries there, jaws opened by instrument.jaw between
/// them. Sizes follow 5 mm instruments of the trade and scale with the shaft's radius. Nothing where none is mounted.
[[nodiscard]] std::vector<InstrumentPart> makeInstrument(const InstrumentView& instrument);

}  // namespace calot::gui
