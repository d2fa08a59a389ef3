// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "sim/math/linear.h"

namespace calot::gui {

/// Centre of the light source beside the lens, in C (m).
inline constexpr float lightX = 0.0045F, lightY = -0.0050F;

/// Visible part of a picture: all of it, or the round field of an endoscope.
struct Sight {
  double aside = 1.0, up = 1.0;      ///< of what is seen, |x| <= aside z and |y| <= up z in C
  float rim = 0.0F;                  ///< radius of the round field (pixels); 0: no field
  float feather = 0.0F;              ///< half the width of its soft edge (pixels)
  float halfX = 0.0F, halfY = 0.0F;  ///< half axes of the polygon around it (clip coordinates); 0: no field

  /// Tangent of the half width of the light's field.
  [[nodiscard]] double lit() const;
};

/// Number of sides of the polygon that approximates the round field.
inline constexpr int fieldSides = 96;

/// @param width, height of the picture (pixels) @param field is there a round field?
[[nodiscard]] Sight sightOf(int width, int height, double verticalFieldOfView, bool field);

/// Bits of placeIn().
struct Place {
  static constexpr std::uint8_t sides = 0x1F;  ///< beyond which of the five sides: left, right, above, below, behind
  static constexpr std::uint8_t edge = 0x20;   ///< not well within
};

/// Position of a point of C relative to the visible part. If all points of a set share a side, their convex hull is
/// invisible beyond it, and so are its shadows.
/// @return bits of Place
[[nodiscard]] std::uint8_t placeIn(const Sight& sight, const Vec3& p_C);

/// Does a triangle of a closed body face away from both lens and light?
/// @param a, b, c counter-clockwise from outside
[[nodiscard]] bool turnedAway(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace calot::gui
