// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

namespace calot::gui {

/// Sides of the fibre texture (texels): across the fibres and along them. It repeats in both directions.
inline constexpr int fibreColumns = 512;
inline constexpr int fibreRows = 256;

/// A picture of areolar tissue: fibres along t that branch and join, in a gossamer film with gaps, from the noise
/// volume. Four bytes a texel, s fastest: cover by fibres (0 to 255), thickness of the film, height's slope across the
/// fibres (128: level), tone.
/// @return 4 fibreColumns fibreRows values
[[nodiscard]] std::vector<std::uint8_t> makeFibreTexture();

}  // namespace calot::gui
