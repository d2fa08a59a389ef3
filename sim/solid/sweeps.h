// SPDX-License-Identifier: GPL-3.0-or-later
// The kernels of ConjugateGradient. Internal to this folder. Each processes a whole matrix eight lanes at a time: the
// rows of one slice, or (Many) eight right-hand sides of one row. Vectors have three components of eight lanes each.
// Vectors that blocks multiply or add to, u and s, are stored by rows as well or instead, rowStride numbers each (Many:
// both layouts coincide): gathering single lanes would take three times as long.
#pragma once

#include <cstddef>
#include <cstdint>

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

/// With a lattice (lattice_gradient.cpp): from the last row to the first t = inverse (z - u),  p = t + c + beta p, and
/// u += block^T t, w += block^T p at the blocks' columns.
/// @param uw u and w, pairs of rows @param pq p in the first of pairs of rows
void backwardPairs(const Slices& matrix, const float* z, const float* c, float beta, float* p, float* uw, float* pq);

/// q = sum of lower p + diagonal p + w,  s = inverse (q - sum of lower s); adds p . q to dot, per lane.
/// @param uw w in the second of pairs of rows @param pq p and s, pairs of rows: p given, s found
void forwardPairs(const Slices& matrix, const float* p, const float* uw, float* pq, float* q, float* s, double* dot);

/// x += alpha p,  r -= alpha q,  y -= alpha s,  z = diagonal y; adds y . z to dot, per lane.
void updatePairs(const Slices& matrix, float alpha, const float* p, const float* q, const float* s, float* x, float* r,
                 float* y, float* z, double* dot);

}  // namespace calot::sweeps
