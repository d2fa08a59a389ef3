// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace calot::gui {

/// Side of the noise volume (texels) and cells along it: 8 texels a cell, so that linear filtering stays smooth.
inline constexpr int noiseSide = 64;
inline constexpr int noiseCells = 8;

/// A periodic volume of gradient noise for procedural colours and bumps: for each texel (x fastest) the derivatives of
/// the noise by the three coordinates in cells, then its value, all within about [-2, 2] and [-1, 1]. Quintic fade
/// (Perlin, "Improving noise", SIGGRAPH 2002), gradients by an integer hash, so the volume is the same everywhere.
/// @return 4 noiseSide^3 values
[[nodiscard]] std::vector<float> makeNoiseVolume();

}  // namespace calot::gui
