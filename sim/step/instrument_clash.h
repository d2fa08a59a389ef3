// SPDX-License-Identifier: GPL-3.0-or-later
// One instrument against the other: both are unions of capsules, so the distance is exact. Internal to this folder.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/step/contact_block.h"
#include "sim/step/placed_instrument.h"

namespace calot {

/// Coulomb coefficient of an instrument on the other. Larger: shafts that cross drag each other along; smaller: they
/// slide off. Assumed: wet polished steel.
inline constexpr double instrumentFriction = 0.1;

/// A point at which instruments a and b are near each other.
struct ClashPoint {
  Vec3 onA = Vec3::Zero();  ///< points of the axes of both capsules (m, W)
  Vec3 onB = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  ///< unit, from b towards a
  double gap = 0.0;            ///< distance of the surfaces, negative: overlap (m)
  std::uint64_t key = 0;       ///< pieces of a and b, with clashKey
};

/// Bits 56 to 63 of a clash's key; no piece of an instrument has this number.
inline constexpr std::uint64_t clashKey = std::uint64_t{0xFF} << 56U;

/// Are two instruments surely farther apart than `reach`? One test of their axes.
bool surelyApart(const PlacedInstrument& a, const PlacedInstrument& b, double reach);

/// Least distance of two instruments' surfaces (m), negative where they overlap; at most `limit`. Points in a port,
/// where the tip hardly feels what pushes, do not count, here and below: shafts cross there in the abdominal wall.
double gapBetween(const PlacedInstrument& a, const PlacedInstrument& b, double limit);

/// The nearest points of two instruments, nearer than `reach`: the nearest pair of pieces first, then every pair that
/// is not beside one that is listed already; at most `maxClashPoints`.
void clashPoints(const PlacedInstrument& a, const PlacedInstrument& b, double reach, std::vector<ClashPoint>& out);
inline constexpr std::size_t maxClashPoints = 4;  ///< two rigid straight bodies need no more

}  // namespace calot
