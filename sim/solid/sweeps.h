// SPDX-License-Identifier: GPL-3.0-or-later
// The kernels of ConjugateGradient. Internal to this folder. Each processes a whole matrix eight lanes at a time: the
// rows of one slice, or (Many) eight right-hand sides of one row. Vectors have three components of eight lanes each.
// Vectors that blocks multiply or add to, u and s, are stored by rows as well or instead, rowStride numbers each (Many:
// both layouts coincide): gathering single lanes would take three times as long.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/math/vectors.h"
#include "sim/solid/block_matrix.h"

namespace calot::sweeps {

/// A matrix and the inverses of its diagonal blocks, 9 x 8 lanes per slice.
struct Slices {
  const float* value;
  const float* inverse;
  const std::int32_t* column;
  const std::size_t* first;     ///< per slice: its first block column
  const std::size_t* diagonal;  ///< per slice: the block column of its diagonal
  std::size_t count;
};

/// Inverts the diagonal blocks; zero for singular ones, which are padding rows.
void invertDiagonal(const Slices& matrix, float* inverse);

/// From the last row to the first: p = z + beta p, t = inverse (p - u), and u += block^T t at the blocks' columns.
/// @param u by rows: contributions of later rows
void backward(const Slices& matrix, const float* z, float beta, float* p, float* t, float* u);
/// @param beta per lane
void backwardMany(const Slices& matrix, const float* z, const float* beta, float* p, float* t, float* u);

/// s = inverse (u - sum of lower s); adds p . (t + s) to dot, per lane. @param u by rows @param sRows copy of s by rows
void forward(const Slices& matrix, const float* u, float* s, float* sRows, const float* p, const float* t, double* dot);
void forwardMany(const Slices& matrix, const float* u, float* s, const float* p, const float* t, double* dot);

/// x += alpha t,  r -= alpha (t + s),  z = diagonal r; adds r . z to dot, per lane.
void update(const Slices& matrix, float alpha, const float* t, const float* s, float* x, float* r, float* z,
            double* dot);
/// @param alpha per lane
void updateMany(const Slices& matrix, const float* alpha, const float* t, const float* s, float* x, float* r, float* z,
                double* dot);

/// With a lattice (coarse_lattice.cpp): from the last row to the first t = inverse (z - u),  p = t + c + beta p, and
/// u += block^T t, w += block^T p at the blocks' columns.
/// @param uw u and w, pairs of rows @param pq p in the first of pairs of rows
void backwardPairs(const Slices& matrix, const float* z, const float* c, float beta, float* p, float* uw, float* pq);

/// q = sum of lower p + diagonal p + w,  s = inverse (q - sum of lower s); adds p . q to dot, per lane.
/// @param uw w in the second of pairs of rows @param pq p and s, pairs of rows: p given, s found
void forwardPairs(const Slices& matrix, const float* p, const float* uw, float* pq, float* q, float* s, double* dot);

/// x += alpha p,  r -= alpha q,  y -= alpha s,  z = diagonal y; adds y . z to dot, per lane.
void updatePairs(const Slices& matrix, float alpha, const float* p, const float* q, const float* s, float* x, float* r,
                 float* y, float* z, double* dot);

// Block-vector products, eight lanes at a time.

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

using rows::Eight;

/// One row of a block times d. @param value its first entry: one per lane, or (many) one for all lanes
template <bool many>
CALOT_INLINE void rowTimes(const float* value, const Eight* d, Eight& out) {
  if constexpr (many) {
    out = (value[0] * d[0] + value[laneCount] * d[1]) + value[2 * laneCount] * d[2];
  } else {
    Eight v[3];
    readVectors<3>(value, v);
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
