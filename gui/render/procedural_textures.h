// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
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

/// Sides of the fibre texture (texels): across the fibres and along them. It repeats in both directions.
inline constexpr int fibreColumns = 512;
inline constexpr int fibreRows = 256;

/// A picture of areolar tissue: fibres along t that branch and join, in a gossamer film with gaps, from the noise
/// volume. Four bytes a texel, s fastest: cover by fibres (0 to 255), thickness of the film, height's slope across the
/// fibres (128: level), tone.
/// @return 4 fibreColumns fibreRows values
[[nodiscard]] std::vector<std::uint8_t> makeFibreTexture();

/// Side of the texture of veins (texels). It repeats in both directions.
inline constexpr int veinSide = 512;

/// Veins as they branch under serosa: trunks that wander along t, divide into ever thinner ones by Murray's law (the
/// cubes of the radii add up), and fade as they thin out. One byte a texel, s fastest: cover, 0 to 255.
/// @return veinSide^2 values, the same everywhere
[[nodiscard]] std::vector<std::uint8_t> makeVeinTexture();

}  // namespace calot::gui
