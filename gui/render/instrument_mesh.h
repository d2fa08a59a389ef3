// SPDX-License-Identifier: GPL-3.0-or-later
// Drawings of instruments and clips. Sizes are those of the contact shapes (sim/instruments).
#pragma once

#include <vector>

#include "gui/render/draw_list.h"
#include "gui/render/mesh.h"
#include "sim/scene/scene_view.h"

namespace calot::gui {

struct InstrumentPart {
  Appearance appearance = Appearance::steel;
  Mesh mesh;  ///< in the instrument's frame I: origin at the tip, z along the shaft towards it, x along the jaws' hinge
              ///< (m)
};

/// Shaft from beyond the port to the tip, and what the instrument carries there, jaws opened by instrument.jaw between
/// them. Sizes follow 5 mm instruments of the trade and scale with the shaft's radius. Nothing where none is mounted.
[[nodiscard]] std::vector<InstrumentPart> makeInstrument(const InstrumentView& instrument);

/// A closed clip in its own frame (m): two flat legs along y around a gap of three quarters of 2 halfGap (they bite
/// into the wall), joined by a crotch at y = -legs / 2, a little open there as bent wire stays; `width` along z. Wire
/// thickness is half the width.
[[nodiscard]] Mesh makeClip(const ClipView& clip);

}  // namespace calot::gui
