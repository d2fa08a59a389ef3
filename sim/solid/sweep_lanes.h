// SPDX-License-Identifier: GPL-3.0-or-later
// Block-vector products of the sweeps, eight lanes at a time. Internal to this folder.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/math/vectors.h"
#include "sim/solid/row_lanes.h"
#include "sim/solid/sweeps.h"

namespace calot::sweeps {

using rows::Eight;

/// One row of a block times d. @param value its first entry: one per lane, or (many) one for all lanes
template <bool many>
CALOT_INLINE void rowTimes(const float* value, const Eight* d, Eight& out) {
  if constexpr (many) {
    out = (value[0] * d[0] + value[laneCount] * d[1]) + value[2 * laneCount] * d[2];
  } else {
    Eight v[3];
    readVector(value, v);
    out = (v[0] * d[0] + v[1] * d[1]) + v[2] * d[2];
  }
}

/// out = block d.
template <bool many>
CALOT_INLINE void product(const float* block, const Eight* d, Eight* out) {
  for (std::size_t i = 0; i < 3; ++i) rowTimes<many>(block + 3 * i * laneCount, d, out[i]);
}

/// One column of a block, which is a row of its transpose, times d.
template <bool many>
CALOT_INLINE void columnTimes(const float* value, const Eight* d, Eight& out) {
  if constexpr (many) {
    out = (value[0] * d[0] + value[3 * laneCount] * d[1]) + value[6 * laneCount] * d[2];
  } else {
    Eight v[3];
    for (std::size_t i = 0; i < 3; ++i) readVector(value + 3 * i * laneCount, v[i]);
    out = (v[0] * d[0] + v[1] * d[1]) + v[2] * d[2];
  }
}

/// Blocks left of the diagonal of a slice, or (many) of one of its rows, starting at its lane.
struct Blocks {
  const float* value;
  const std::int32_t* column;
  std::size_t width;
};
CALOT_INLINE void blocksOf(const Slices& matrix, std::size_t slice, std::size_t lane, Blocks& out) {
  const std::size_t first = matrix.first[slice];
  out = {matrix.value + first * 9 * laneCount + lane, matrix.column + first * laneCount + lane,
         matrix.diagonal[slice] - first};
}
CALOT_INLINE const float* diagonalOf(const Slices& matrix, std::size_t slice) {
  return matrix.value + matrix.diagonal[slice] * 9 * laneCount;
}
CALOT_INLINE const float* inverseOf(const Slices& matrix, std::size_t slice) {
  return matrix.inverse + slice * 9 * laneCount;
}

}  // namespace calot::sweeps
