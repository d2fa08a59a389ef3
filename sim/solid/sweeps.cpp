// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/sweeps.h"

namespace calot::sweeps {

namespace {

#define CALOT_INLINE inline __attribute__((always_inline))  // into the clones of the kernels

/// Entry `at` of the blocks of all lanes: of each its own, or of one row for all.
template <bool many>
CALOT_INLINE float entry(const float* value, std::size_t at, std::size_t lane) {
  return value[at * laneCount + (many ? 0 : lane)];
}

/// y = sum of blocks x.
template <bool many>
CALOT_INLINE void addProducts(const Blocks& blocks, const float* x, float* y0, float* y1, float* y2) {
  for (std::size_t k = 0; k < blocks.width; ++k) {
    const float* v = blocks.value + k * 9 * laneCount;
    const std::int32_t* c = blocks.column + k * laneCount;
    // The offset of a row in the layout of one vector gives its row, and so its place in the layout of eight.
    const auto first = static_cast<std::size_t>(c[0]);
    const float* all = many ? x + (first / laneStride * laneCount + first % laneStride) * laneStride : x;
    for (std::size_t l = 0; l < laneCount; ++l) {
      const std::size_t column = many ? l : static_cast<std::size_t>(c[l]);
      const float x0 = all[column];
      const float x1 = all[column + laneCount];
      const float x2 = all[column + 2 * laneCount];
      y0[l] += (entry<many>(v, 0, l) * x0 + entry<many>(v, 1, l) * x1) + entry<many>(v, 2, l) * x2;
      y1[l] += (entry<many>(v, 3, l) * x0 + entry<many>(v, 4, l) * x1) + entry<many>(v, 5, l) * x2;
      y2[l] += (entry<many>(v, 6, l) * x0 + entry<many>(v, 7, l) * x1) + entry<many>(v, 8, l) * x2;
    }
  }
}

/// out = block d.
template <bool many>
CALOT_INLINE void product(const float* block, const float* d0, const float* d1, const float* d2, float* out) {
  for (std::size_t l = 0; l < laneCount; ++l) {
    out[l] = (entry<many>(block, 0, l) * d0[l] + entry<many>(block, 1, l) * d1[l]) + entry<many>(block, 2, l) * d2[l];
    out[8 + l] =
        (entry<many>(block, 3, l) * d0[l] + entry<many>(block, 4, l) * d1[l]) + entry<many>(block, 5, l) * d2[l];
    out[16 + l] =
        (entry<many>(block, 6, l) * d0[l] + entry<many>(block, 7, l) * d1[l]) + entry<many>(block, 8, l) * d2[l];
  }
}

template <bool many>
CALOT_INLINE void backwardLanes(const Blocks& upper, const float* inverse, const float* z, const float* beta, float* p,
                                float* t, float* u, std::size_t at) {
  float y0[laneCount] = {};
  float y1[laneCount] = {};
  float y2[laneCount] = {};
  addProducts<many>(upper, t, y0, y1, y2);
  for (std::size_t l = 0; l < laneCount; ++l) {
    u[at + l] = y0[l];
    u[at + 8 + l] = y1[l];
    u[at + 16 + l] = y2[l];
  }
  for (std::size_t l = 0; l < laneCount; ++l) {
    const float p0 = z[at + l] + beta[l] * p[at + l];
    const float p1 = z[at + 8 + l] + beta[l] * p[at + 8 + l];
    const float p2 = z[at + 16 + l] + beta[l] * p[at + 16 + l];
    y0[l] = p0 - y0[l];
    y1[l] = p1 - y1[l];
    y2[l] = p2 - y2[l];
    p[at + l] = p0;
    p[at + 8 + l] = p1;
    p[at + 16 + l] = p2;
  }
  product<many>(inverse, y0, y1, y2, t + at);
}

template <bool many>
CALOT_INLINE void forwardLanes(const Blocks& lower, const float* inverse, const float* u, float* s, const float* p,
                               const float* t, double* dot, std::size_t at) {
  float y0[laneCount] = {};
  float y1[laneCount] = {};
  float y2[laneCount] = {};
  addProducts<many>(lower, s, y0, y1, y2);
  for (std::size_t l = 0; l < laneCount; ++l) {
    y0[l] = u[at + l] - y0[l];
    y1[l] = u[at + 8 + l] - y1[l];
    y2[l] = u[at + 16 + l] - y2[l];
  }
  product<many>(inverse, y0, y1, y2, s + at);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t l = 0; l < laneCount; ++l) {
      const std::size_t a = at + i * laneCount + l;
      dot[l] += static_cast<double>(p[a]) * static_cast<double>(t[a] + s[a]);
    }
  }
}

template <bool many>
CALOT_INLINE void updateLanes(const float* diagonal, const float* alpha, const float* t, const float* s, float* x,
                              float* r, float* z, double* dot, std::size_t at) {
  float next[3][laneCount];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t l = 0; l < laneCount; ++l) {
      const std::size_t a = at + i * laneCount + l;
      x[a] += alpha[l] * t[a];
      next[i][l] = r[a] - alpha[l] * (t[a] + s[a]);
    }
  }
  float scaled[laneStride];
  product<many>(diagonal, next[0], next[1], next[2], scaled);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t l = 0; l < laneCount; ++l) {
      const std::size_t a = at + i * laneCount + l;
      r[a] = next[i][l];
      z[a] = scaled[i * laneCount + l];
      dot[l] += static_cast<double>(next[i][l]) * static_cast<double>(scaled[i * laneCount + l]);
    }
  }
}

}  // namespace

CALOT_LANE_KERNEL void backward(const Blocks& upper, const float* inverse, const float* z, const float* beta, float* p,
                                float* t, float* u, std::size_t at) {
  backwardLanes<false>(upper, inverse, z, beta, p, t, u, at);
}

CALOT_LANE_KERNEL void backwardMany(const Blocks& upper, const float* inverse, const float* z, const float* beta,
                                    float* p, float* t, float* u, std::size_t at) {
  backwardLanes<true>(upper, inverse, z, beta, p, t, u, at);
}

CALOT_LANE_KERNEL void forward(const Blocks& lower, const float* inverse, const float* u, float* s, const float* p,
                               const float* t, double* dot, std::size_t at) {
  forwardLanes<false>(lower, inverse, u, s, p, t, dot, at);
}

CALOT_LANE_KERNEL void forwardMany(const Blocks& lower, const float* inverse, const float* u, float* s, const float* p,
                                   const float* t, double* dot, std::size_t at) {
  forwardLanes<true>(lower, inverse, u, s, p, t, dot, at);
}

CALOT_LANE_KERNEL void update(const float* diagonal, const float* alpha, const float* t, const float* s, float* x,
                              float* r, float* z, double* dot, std::size_t at) {
  updateLanes<false>(diagonal, alpha, t, s, x, r, z, dot, at);
}

CALOT_LANE_KERNEL void updateMany(const float* diagonal, const float* alpha, const float* t, const float* s, float* x,
                                  float* r, float* z, double* dot, std::size_t at) {
  updateLanes<true>(diagonal, alpha, t, s, x, r, z, dot, at);
}

}  // namespace calot::sweeps
