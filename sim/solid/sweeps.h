// SPDX-License-Identifier: GPL-3.0-or-later
// The kernels of ConjugateGradient. Internal to this folder. Each takes eight lanes: the rows of one slice, or (Many)
// of one row eight right-hand sides. Vectors have three components of eight lanes, which begin `at` for these rows; but
// what the blocks are multiplied with or added to, u and s, also or only goes by rows: rowStride numbers for each
// (Many: it is the same). Gathering lanes one by one would take three times as long.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/solid/block_matrix.h"

namespace calot::sweeps {

/// Blocks left of the diagonal. Many: advanced to the lane of the row.
struct Blocks {
  const float* value;
  const std::int32_t* column;
  std::size_t width;
};

/// p = z + beta p,  t = inverse (p - u), and where the blocks' columns are, u += block^T t.
/// @param beta per lane @param u by rows: what rows further down added to it
void backward(const Blocks& lower, const float* inverse, const float* z, const float* beta, float* p, float* t,
              float* u, std::size_t at);
void backwardMany(const Blocks& lower, const float* inverse, const float* z, const float* beta, float* p, float* t,
                  float* u, std::size_t at);

/// s = inverse (u - sum of lower s); adds p . (t + s) to dot, per lane. @param u by rows @param sRows copy of s by rows
void forward(const Blocks& lower, const float* inverse, const float* u, float* s, float* sRows, const float* p,
             const float* t, double* dot, std::size_t at);
void forwardMany(const Blocks& lower, const float* inverse, const float* u, float* s, const float* p, const float* t,
                 double* dot, std::size_t at);

/// x += alpha t,  r -= alpha (t + s),  z = diagonal r; adds r . z to dot, per lane. @param alpha per lane
void update(const float* diagonal, const float* alpha, const float* t, const float* s, float* x, float* r, float* z,
            double* dot, std::size_t at);
void updateMany(const float* diagonal, const float* alpha, const float* t, const float* s, float* x, float* r, float* z,
                double* dot, std::size_t at);

}  // namespace calot::sweeps
