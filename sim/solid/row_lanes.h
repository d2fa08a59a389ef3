// SPDX-License-Identifier: GPL-3.0-or-later
// Kernels on whole vectors stored by rows (rowStride numbers each). Internal to this folder.

// Vectors by rows (rowStride numbers each) to and from lanes (one row a lane). Internal to this folder.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sim/math/vectors.h"
#include "sim/solid/block_matrix.h"

namespace calot::rows {

using Four = FourFloats;
using Eight = EightFloats;

/// Concatenates two rows of four numbers.
CALOT_INLINE void join(const Four& low, const Four& high, Eight& out) {
  out = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}

/// Transposes eight rows, the l-th at x + row[l], to three components of eight lanes.
CALOT_INLINE void toLanes(const float* x, const std::int32_t* row, Eight* out) {
  Four first[4];  // of rows 2 l and 2 l + 1: x x y y
  Four last[4];   // and z z and padding
  for (std::size_t l = 0; l < 4; ++l) {
    Four a;
    Four b;
    readVector(x + row[2 * l], a);
    readVector(x + row[2 * l + 1], b);
    first[l] = __builtin_shufflevector(a, b, 0, 4, 1, 5);
    last[l] = __builtin_shufflevector(a, b, 2, 6, 3, 7);
  }
  Eight even;
  Eight odd;
  join(first[0], first[2], even);
  join(first[1], first[3], odd);
  out[0] = __builtin_shufflevector(even, odd, 0, 1, 8, 9, 4, 5, 12, 13);
  out[1] = __builtin_shufflevector(even, odd, 2, 3, 10, 11, 6, 7, 14, 15);
  join(last[0], last[2], even);
  join(last[1], last[3], odd);
  out[2] = __builtin_shufflevector(even, odd, 0, 1, 8, 9, 4, 5, 12, 13);
}

/// Transposes three components of eight lanes, and padding, to eight rows: row l in half l / 4 of out[l % 4].
CALOT_INLINE void toRows(const Eight* lanes, const Eight& last, Eight* out) {
  const Eight low = __builtin_shufflevector(lanes[0], lanes[1], 0, 8, 1, 9, 4, 12, 5, 13);
  const Eight high = __builtin_shufflevector(lanes[0], lanes[1], 2, 10, 3, 11, 6, 14, 7, 15);
  const Eight lowLast = __builtin_shufflevector(lanes[2], last, 0, 8, 1, 9, 4, 12, 5, 13);
  const Eight highLast = __builtin_shufflevector(lanes[2], last, 2, 10, 3, 11, 6, 14, 7, 15);
  out[0] = __builtin_shufflevector(low, lowLast, 0, 1, 8, 9, 4, 5, 12, 13);
  out[1] = __builtin_shufflevector(low, lowLast, 2, 3, 10, 11, 6, 7, 14, 15);
  out[2] = __builtin_shufflevector(high, highLast, 0, 1, 8, 9, 4, 5, 12, 13);
  out[3] = __builtin_shufflevector(high, highLast, 2, 3, 10, 11, 6, 7, 14, 15);
}

CALOT_INLINE void toRows(const Eight* lanes, Eight* out) { toRows(lanes, Eight{}, out); }

/// Adds four numbers.
CALOT_INLINE void addTo(float* at, const Four& what) {
  Four own;
  readVector(at, own);
  own += what;
  writeVector(own, at);
}

/// Adds three components of eight lanes to rows, the l-th at x + row[l], in order of the lanes.
CALOT_INLINE void addRows(const Eight* lanes, const std::int32_t* row, float* x) {
  Eight rows[4];
  toRows(lanes, rows);
  for (std::size_t l = 0; l < 4; ++l) addTo(x + row[l], __builtin_shufflevector(rows[l], rows[l], 0, 1, 2, 3));
  for (std::size_t l = 0; l < 4; ++l) addTo(x + row[4 + l], __builtin_shufflevector(rows[l], rows[l], 4, 5, 6, 7));
}

/// Numbers of a pair of rows, one from each of two vectors.
inline constexpr std::size_t pairStride = 2 * rowStride;

/// Interleaves numbers of a and b: the first two of each half, and (high) the last two.
CALOT_INLINE void interleave(const Eight& a, const Eight& b, Eight& low, Eight& high) {
  low = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
  high = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
}
/// Interleaves pairs of numbers of a and b: the first of each half, and (high) the second.
CALOT_INLINE void interleavePairs(const Eight& a, const Eight& b, Eight& low, Eight& high) {
  low = __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
  high = __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
}
/// The first halves of a and b, and (high) the second.
CALOT_INLINE void halves(const Eight& a, const Eight& b, Eight& low, Eight& high) {
  low = __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11);
  high = __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15);
}

/// Transposes eight pairs of rows, the l-th at x + 2 row[l], to three components of eight lanes of each vector.
CALOT_INLINE void pairsToLanes(const float* x, const std::int32_t* row, Eight* first, Eight* second) {
  Eight part[2][3];  // component i of rows 4 h to 4 h + 3, of each vector in a half
  for (std::size_t h = 0; h < 2; ++h) {
    Eight own[4];
    for (std::size_t l = 0; l < 4; ++l) readVector(x + 2 * row[4 * h + l], own[l]);
    Eight cross[4];
    interleave(own[0], own[1], cross[0], cross[1]);
    interleave(own[2], own[3], cross[2], cross[3]);
    Eight fill;
    interleavePairs(cross[0], cross[2], part[h][0], part[h][1]);
    interleavePairs(cross[1], cross[3], part[h][2], fill);
  }
  for (std::size_t i = 0; i < 3; ++i) halves(part[0][i], part[1][i], first[i], second[i]);
}

/// Adds three components of eight lanes of each of two vectors to pairs of rows, in order of the lanes.
CALOT_INLINE void addPairs(const Eight* first, const Eight* second, const std::int32_t* row, float* x) {
  Eight part[2][3];
  for (std::size_t i = 0; i < 3; ++i) halves(first[i], second[i], part[0][i], part[1][i]);
  const Eight none{};
  for (std::size_t h = 0; h < 2; ++h) {
    Eight cross[4];
    interleave(part[h][0], part[h][1], cross[0], cross[1]);
    interleave(part[h][2], none, cross[2], cross[3]);
    Eight out[4];
    interleavePairs(cross[0], cross[2], out[0], out[1]);
    interleavePairs(cross[1], cross[3], out[2], out[3]);
    for (std::size_t l = 0; l < 4; ++l) {
      float* at = x + 2 * row[4 * h + l];
      Eight own;
      readVector(at, own);
      own += out[l];
      writeVector(own, at);
    }
  }
}

/// Offsets of consecutive rows.
inline constexpr std::int32_t inOrder[laneCount] = {0, 4, 8, 12, 16, 20, 24, 28};
static_assert(rowStride == 4 && laneCount == 8);

/// Stores a slice's rows in a vector stored by rows.
CALOT_INLINE void storeRows(const Eight* lanes, float* rows) {
  Eight out[4];
  toRows(lanes, out);
  for (std::size_t l = 0; l < 4; ++l) {
    writeVector(Four(__builtin_shufflevector(out[l], out[l], 0, 1, 2, 3)), rows + inOrder[l]);
    writeVector(Four(__builtin_shufflevector(out[l], out[l], 4, 5, 6, 7)), rows + inOrder[4 + l]);
  }
}

/// Stores a slice's rows as the first or the second of pairs.
CALOT_INLINE void storeFirst(const Eight* lanes, float* pairs) {
  Eight out[4];
  toRows(lanes, out);
  for (std::size_t l = 0; l < 4; ++l) {
    writeVector(Four(__builtin_shufflevector(out[l], out[l], 0, 1, 2, 3)), pairs + l * pairStride);
    writeVector(Four(__builtin_shufflevector(out[l], out[l], 4, 5, 6, 7)), pairs + (4 + l) * pairStride);
  }
}
CALOT_INLINE void storeSecond(const Eight* lanes, float* pairs) { storeFirst(lanes, pairs + rowStride); }

/// The rows of a slice as lanes. @param rows the first of them
CALOT_INLINE void lanesOf(const float* rows, Eight* out) { toLanes(rows, inOrder, out); }

}  // namespace calot::rows

namespace calot::sweeps {

/// Lattice nodes at the corners of a row's cell: the ends of four edges.
struct Share {
  static constexpr std::size_t corners = 8;
  std::array<std::uint32_t, corners / 2> edge{};  ///< numbers of edges
  std::array<float, corners> weight{};            ///< of the ends of the first edge, of the second, ...
};

/// A row in which a lattice node has a share.
struct Part {
  std::uint32_t row;  ///< offset in vectors stored by rows
  float weight;
};

/// Rows of R^T in, with R the rotation of each row. @param quaternion of each slice's rows: w, x, y, z,
/// eight lanes each (unit)
/// @param in in lanes
void unrotateRows(const float* quaternion, const float* in, float* out, std::size_t slices);

/// The inverse: R in, in lanes. @param in by rows
void rotateRows(const float* quaternion, const float* in, float* out, std::size_t slices);

/// a . b, in double, in eight sums. @param count number of values, a multiple of eight
double dot(const float* a, const float* b, std::size_t count);

/// out = sum of weight times row. @param out three numbers
void gather(const Part* part, std::size_t count, const float* rows, float* out);

/// out = matrix in. @param matrix `size` rows of `stride` numbers, whole eights @param out by rows of three
void denseTimes(const float* matrix, const float* in, std::size_t size, std::size_t stride, float* out);

/// out = per row the sum of weight times lattice node, by rows. @param edges per edge the rows of both ends
void spread(const Share* share, std::size_t count, const float* edges, float* out);

}  // namespace calot::sweeps
