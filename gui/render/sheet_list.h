// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "sim/scene/scene_view.h"

namespace calot::gui {

/// A vertex of connective tissue, in the camera's frame C (x right, y down, z forward).
struct SheetVertex {
  float position[3];  ///< m
  float normal[3];    ///< unit, of the sheet; either side
  float along[3];     ///< unit, direction of the fibres
  float look[4];      ///< place in the fibre texture (s, t); opacity; share burnt
  float erosion;      ///< share of the fibre texture that is gone: 0 whole, 1 nothing; below 0: matted
};

/// All connective tissue of one picture, back to front for blending.
struct SheetList {
  std::vector<SheetVertex> vertex;
  std::vector<std::uint32_t> index;  ///< of triangles
};

/// Sheets where both strands of a pair are attached, tufts at both ends of torn strands, dark stumps at both ends of
/// burned ones. Strands sag slightly, by an amount that depends on their index alone, as does the part of the fibre
/// texture that a sheet shows. Order: by depth of a piece's centre, then by index.
/// @pre checkView(view) has passed
[[nodiscard]] SheetList makeSheetList(const SceneView& view);

}  // namespace calot::gui
