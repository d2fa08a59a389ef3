// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds rounded outward to float, so that a broad phase in single precision loses no pair.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

#include "sim/math/linear.h"

namespace calot {

/// Largest float not above x; minus infinity below -FLT_MAX. @pre x is a number
[[nodiscard]] inline float floatBelow(double x) {
  constexpr float largest = std::numeric_limits<float>::max();
  if (x >= static_cast<double>(largest)) return largest;
  if (x < -static_cast<double>(largest)) return -std::numeric_limits<float>::infinity();
  const auto nearest = static_cast<float>(x);
  if (static_cast<double>(nearest) <= x) return nearest;
  if (nearest == 0.0F) return -std::numeric_limits<float>::denorm_min();
  // One unit in the last place down: the magnitude's bits count up for a negative number, down for a positive one.
  const auto bits = std::bit_cast<std::uint32_t>(nearest);
  return std::bit_cast<float>(nearest > 0.0F ? bits - 1U : bits + 1U);
}

/// Smallest float not below x.
[[nodiscard]] inline float floatAbove(double x) { return -floatBelow(-x); }

/// Smallest box with float coordinates that contains this one.
[[nodiscard]] inline Box outwardBox(const Box& box) {
  Box out;
  for (int a = 0; a < 3; ++a) {
    out.lower[a] = static_cast<double>(floatBelow(box.lower[a]));
    out.upper[a] = static_cast<double>(floatAbove(box.upper[a]));
  }
  return out;
}

}  // namespace calot
