// SPDX-License-Identifier: GPL-3.0-or-later
// What the readers of triangle surfaces (OBJ, STL, PLY) share: the unit, which no such file says, and what is too much.
#pragma once

#include <cstddef>
#include <string>

namespace calot::recorder {

/// A surface file says no unit: whoever names the file must.
enum class LengthUnit { metre, centimetre, millimetre };

/// Metres in one unit.
double metres(LengthUnit unit);

/// "m", "cm" or "mm". @throws Error (invalid)
LengthUnit parseLengthUnit(const std::string& word);

/// What a file may hold. Beyond it is refused, at the place where it happens.
struct SurfaceLimits {
  std::size_t bytes = std::size_t{256} << 20U;
  std::size_t vertices = 5'000'000;
  std::size_t triangles = 10'000'000;
};

/// Farther from the origin than this nothing is an organ, and sums of squares stay far from overflow (m).
inline constexpr double farthestCoordinate = 1000.0;

}  // namespace calot::recorder
