// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

namespace calot::gui {

/// Side of the texture of veins (texels). It repeats in both directions.
inline constexpr int veinSide = 512;

/// Veins as they branch under serosa: trunks that wander along t, divide into ever thinner ones by Murray's law (the
/// cubes of the radii add up), and fade as they thin out. One byte a texel, s fastest: cover, 0 to 255.
/// @return veinSide^2 values, the same everywhere
[[nodiscard]] std::vector<std::uint8_t> makeVeinTexture();

}  // namespace calot::gui
