// SPDX-License-Identifier: GPL-3.0-or-later

#include "sim/solid/row_lanes.h"

namespace calot::sweeps {

namespace {

using rows::Eight;
using rows::Four;

constexpr std::size_t sliceRows = laneCount * rowStride;  ///< numbers of a slice by rows

/// v = R v, or R^T v: v + w t + q x t, t = 2 q x v.
CALOT_INLINE void rotate(const float* quaternion, bool back, Eight* v) {
  Eight q[4];
  for (std::size_t i = 0; i < 4; ++i) readVector(quaternion + i * laneCount, q[i]);
  if (back) {
    for (std::size_t i = 1; i < 4; ++i) q[i] = -q[i];
  }
  const Eight t[3] = {2.0F * (q[2] * v[2] - q[3] * v[1]), 2.0F * (q[3] * v[0] - q[1] * v[2]),
                      2.0F * (q[1] * v[1] - q[2] * v[0])};
  v[0] += q[0] * t[0] + (q[2] * t[2] - q[3] * t[1]);
  v[1] += q[0] * t[1] + (q[3] * t[0] - q[1] * t[2]);
  v[2] += q[0] * t[2] + (q[1] * t[1] - q[2] * t[0]);
}

}  // namespace

CALOT_LANE_KERNEL void unrotateRows(const float* quaternion, const float* in, float* out, std::size_t slices) {
  for (std::size_t s = 0; s < slices; ++s) {
    Eight v[3];
    std::memcpy(v, in + s * laneStride, sizeof v);
    rotate(quaternion + s * 4 * laneCount, true, v);
    rows::storeRows(v, out + s * sliceRows);
  }
}

CALOT_LANE_KERNEL void rotateRows(const float* quaternion, const float* in, float* out, std::size_t slices) {
  for (std::size_t s = 0; s < slices; ++s) {
    Eight v[3];
    rows::lanesOf(in + s * sliceRows, v);
    rotate(quaternion + s * 4 * laneCount, false, v);
    std::memcpy(out + s * laneStride, v, sizeof v);
  }
}

CALOT_LANE_KERNEL double dot(const float* a, const float* b, std::size_t count) {
  EightDoubles sum{};
  for (std::size_t k = 0; k < count; k += laneCount) {
    Eight x;
    Eight y;
    readVector(a + k, x);
    readVector(b + k, y);
    sum += __builtin_convertvector(x, EightDoubles) * __builtin_convertvector(y, EightDoubles);
  }
  return ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]));
}

CALOT_LANE_KERNEL void gather(const Part* part, std::size_t count, const float* rows, float* out) {
  Four sum[4] = {};
  Four own;
  std::size_t k = 0;
  for (; k + 4 <= count; k += 4) {
    for (std::size_t i = 0; i < 4; ++i) {
      readVector(rows + part[k + i].row, own);
      sum[i] += part[k + i].weight * own;
    }
  }
  for (; k < count; ++k) {
    readVector(rows + part[k].row, own);
    sum[0] += part[k].weight * own;
  }
  const Four all = (sum[0] + sum[1]) + (sum[2] + sum[3]);
  for (std::size_t i = 0; i < 3; ++i) out[i] = all[i];
}

CALOT_LANE_KERNEL void denseTimes(const float* matrix, const float* in, std::size_t size, std::size_t stride,
                                  float* out) {
  for (std::size_t i = 0; i < size; ++i) {
    Eight sum{};
    for (std::size_t j = 0; j < stride; j += laneCount) {
      Eight value;
      Eight own;
      readVector(matrix + i * stride + j, value);
      readVector(in + j, own);
      sum += value * own;
    }
    out[i / 3 * rowStride + i % 3] = ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]));
  }
}

CALOT_LANE_KERNEL void spread(const Share* share, std::size_t count, const float* edges, float* out) {
  for (std::size_t row = 0; row < count; ++row) {
    Eight weight;
    readVector(share[row].weight.data(), weight);
    const Eight by[4] = {__builtin_shufflevector(weight, weight, 0, 0, 0, 0, 1, 1, 1, 1),
                         __builtin_shufflevector(weight, weight, 2, 2, 2, 2, 3, 3, 3, 3),
                         __builtin_shufflevector(weight, weight, 4, 4, 4, 4, 5, 5, 5, 5),
                         __builtin_shufflevector(weight, weight, 6, 6, 6, 6, 7, 7, 7, 7)};
    Eight sum{};
    for (std::size_t e = 0; e < 4; ++e) {
      Eight ends;
      readVector(edges + static_cast<std::size_t>(share[row].edge[e]) * 2 * rowStride, ends);
      sum += by[e] * ends;
    }
    const Four all =
        Four(__builtin_shufflevector(sum, sum, 0, 1, 2, 3)) + Four(__builtin_shufflevector(sum, sum, 4, 5, 6, 7));
    writeVector(all, out + row * rowStride);
  }
}

}  // namespace calot::sweeps
