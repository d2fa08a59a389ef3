// SPDX-License-Identifier: GPL-3.0-or-later
// The kernels of ConjugateGradient. Internal to this folder. Each takes eight lanes: the rows of one slice, or (Many)
// of one row eight right-hand sides. Vectors have three components of eight lanes, which begin `at` for these rows.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/solid/block_matrix.h"

namespace calot::sweeps {

/// Blocks on one side of the diagonal. Many: advanced to the lane of the row.
struct Blocks {
  const float* value;
  const std::int32_t* column;
  std::size_t width;
};

/// p = z + beta p,  u = sum of upper t,  t = inverse (p - u). @param beta per lane
void backward(const Blocks& upper, const float* inverse, const float* z, const float* beta, float* p, float* t,
              float* u, std::size_t at);
void backwardMany(const Blocks& upper, const float* inverse, const float* z, const float* beta, float* p, float* t,
                  float* u, std::size_t at);

/// s = inverse (u - sum of lower s); adds p . (t + s) to dot, per lane.
void forward(const Blocks& lower, const float* inverse, const float* u, float* s, const float* p, const float* t,
             double* dot, std::size_t at);
void forwardMany(const Blocks& lower, const float* inverse, const float* u, float* s, const float* p, const float* t,
                 double* dot, std::size_t at);

/// x += alpha t,  r -= alpha (t + s),  z = diagonal r; adds r . z to dot, per lane. @param alpha per lane
void update(const float* diagonal, const float* alpha, const float* t, const float* s, float* x, float* r, float* z,
            double* dot, std::size_t at);
void updateMany(const float* diagonal, const float* alpha, const float* t, const float* s, float* x, float* r, float* z,
                double* dot, std::size_t at);

}  // namespace calot::sweeps
