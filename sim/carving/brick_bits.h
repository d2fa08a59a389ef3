// SPDX-License-Identifier: GPL-3.0-or-later
// The nodes of one brick as bits: bit x + 8 y of word z. One word is a layer.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace calot {

using BrickBits = std::array<std::uint64_t, 8>;

inline constexpr std::uint64_t columnFirst = 0x0101010101010101ULL;  ///< x = 0 in a layer
inline constexpr std::uint64_t columnLast = columnFirst << 7U;       ///< x = 7

[[nodiscard]] inline bool testBit(const BrickBits& bits, std::uint32_t local) {
  return (bits[local >> 6U] >> (local & 63U) & 1U) != 0;
}
[[nodiscard]] inline int countBits(const BrickBits& bits) {
  int n = 0;
  for (const std::uint64_t layer : bits) n += std::popcount(layer);
  return n;
}
[[nodiscard]] inline bool anyBit(const BrickBits& bits) {
  std::uint64_t all = 0;
  for (const std::uint64_t layer : bits) all |= layer;
  return all != 0;
}

/// Calls visit(local) for each set bit, ascending; local is the node's index in its brick, x + 8 (y + 8 z).
template <class Visit>
void forEachBit(const BrickBits& bits, Visit&& visit) {
  for (std::uint32_t z = 0; z < 8; ++z) {
    for (std::uint64_t layer = bits[z]; layer != 0; layer &= layer - 1) {
      visit(64 * z + static_cast<std::uint32_t>(std::countr_zero(layer)));
    }
  }
}

/// The set and its neighbours along the axes, within the brick.
[[nodiscard]] inline BrickBits dilated(const BrickBits& b) {
  BrickBits out;
  for (std::size_t z = 0; z < 8; ++z) {
    const std::uint64_t m = b[z];
    out[z] = m | ((m & ~columnLast) << 1U) | ((m & ~columnFirst) >> 1U) | (m << 8U) | (m >> 8U);
    if (z > 0) out[z] |= b[z - 1];
    if (z < 7) out[z] |= b[z + 1];
  }
  return out;
}

/// Nodes of brick `a` whose neighbour in brick `b`, next to it along +axis, is set too, as bits of one face: for x bit
/// 8 y + z, for y bit 8 z + x, for z bit 8 y + x.
[[nodiscard]] inline std::uint64_t sharedFace(const BrickBits& a, const BrickBits& b, int axis) {
  std::uint64_t face = 0;
  if (axis == 2) return a[7] & b[0];
  for (unsigned z = 0; z < 8; ++z) {
    if (axis == 0) {
      face |= ((a[z] >> 7U) & b[z] & columnFirst) << z;
    } else {
      face |= ((a[z] >> 56U) & b[z] & 0xFFU) << (8U * z);
    }
  }
  return face;
}

/// Index in brick `a` and in brick `b` of bit k of their sharedFace.
struct FacePair {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
};
[[nodiscard]] inline FacePair facePair(unsigned k, int axis) {
  const unsigned low = k & 7U;
  const unsigned high = k >> 3U;
  if (axis == 0) return {7 + 8 * (high + 8 * low), 8 * (high + 8 * low)};
  if (axis == 1) return {low + 8 * (7 + 8 * high), low + 64 * high};
  return {k + 64 * 7, k};
}

}  // namespace calot
