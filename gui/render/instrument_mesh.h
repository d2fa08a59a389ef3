// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gui/render/draw_list.h"

namespace calot::gui {

struct InstrumentPart {
  Appearance appearance = Appearance::steel;
  Mesh mesh;  ///< in the instrument's frame I: origin at the tip, z along the shaft towards it, x along the jaws' hinge
              ///< (m)
};

/// Shaft from beyond the port to the tip, and its end effector: two jaws opened by instrument.jaw (grasper,
/// clip applier with a loaded clip, scissors), or an L hook. Sizes follow commercial 5 mm instruments and scale
/// with the shaft's radius.
[[nodiscard]] std::vector<InstrumentPart> makeInstrument(const InstrumentView& instrument);

}  // namespace calot::gui
