// SPDX-License-Identifier: GPL-3.0-or-later
// Common to the readers of triangle surfaces (OBJ, STL, PLY): the unit, which such files do not contain, and limits.
#pragma once

#include <cstddef>
#include <string>

namespace calot::recorder {

/// A surface file contains no unit; whoever names the file must state it.
enum class LengthUnit { metre, centimetre, millimetre };

/// Metres in one unit.
double metres(LengthUnit unit);

/// "m", "cm" or "mm". @throws Error (invalid)
LengthUnit parseLengthUnit(const std::string& word);

/// Limits of a file; a file that exceeds one is refused, naming the location.
struct SurfaceLimits {
  std::size_t bytes = std::size_t{256} << 20U;
  std::size_t vertices = 5'000'000;
  std::size_t triangles = 10'000'000;
};

/// Greatest distance from the origin: no organ is farther, and sums of squares stay far from overflow (m).
inline constexpr double farthestCoordinate = 1000.0;

}  // namespace calot::recorder
