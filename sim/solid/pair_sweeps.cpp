// SPDX-License-Identifier: GPL-3.0-or-later
// Sweeps of two vectors at once.
#include <cstring>

#include "sim/solid/sweep_lanes.h"
#include "sim/solid/sweeps.h"

namespace calot::sweeps {

CALOT_LANE_KERNEL void backwardPairs(const Slices& matrix, const float* z, const float* c, float beta, float* p,
                                     float* uw, float* pq) {
  const Eight by = {beta, beta, beta, beta, beta, beta, beta, beta};
  for (std::size_t s = matrix.count; s-- > 0;) {
    Blocks lower;
    blocksOf(matrix, s, 0, lower);
    const std::size_t pairs = s * laneCount * rows::pairStride;
    Eight y[3];
    Eight unused[3];
    rows::pairsToLanes(uw + pairs, rows::inOrder, y, unused);
    for (std::size_t i = 0; i < 3; ++i) {
      Eight own;
      readVector(z + s * laneStride + i * laneCount, own);
      y[i] = own - y[i];
    }
    Eight t[3];
    product<false>(inverseOf(matrix, s), y, t);
    Eight direction[3];
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t at = s * laneStride + i * laneCount;
      Eight more;
      Eight before;
      readVector(c + at, more);
      readVector(p + at, before);
      direction[i] = (t[i] + more) + by * before;
      writeVector(direction[i], p + at);
    }
    rows::storeFirst(direction, pq + pairs);
    for (std::size_t k = 0; k < lower.width; ++k) {
      const float* value = lower.value + k * 9 * laneCount;
      Eight ofT[3];
      Eight ofP[3];
      for (std::size_t i = 0; i < 3; ++i) {
        Eight v[3];
        for (std::size_t j = 0; j < 3; ++j) readVector(value + (3 * j + i) * laneCount, v[j]);
        ofT[i] = (v[0] * t[0] + v[1] * t[1]) + v[2] * t[2];
        ofP[i] = (v[0] * direction[0] + v[1] * direction[1]) + v[2] * direction[2];
      }
      rows::addPairs(ofT, ofP, lower.column + k * laneCount, uw);
    }
  }
}

CALOT_LANE_KERNEL void forwardPairs(const Slices& matrix, const float* p, const float* uw, float* pq, float* q,
                                    float* s, double* dot) {
  EightDoubles sum;
  readVector(dot, sum);
  for (std::size_t slice = 0; slice < matrix.count; ++slice) {
    Blocks lower;
    blocksOf(matrix, slice, 0, lower);
    const std::size_t pairs = slice * laneCount * rows::pairStride;
    Eight times[3];
    Eight solved[3];
    rows::pairsToLanes(uw + pairs, rows::inOrder, solved, times);  // w; u is no longer needed
    for (std::size_t i = 0; i < 3; ++i) solved[i] = Eight{};
    for (std::size_t k = 0; k < lower.width; ++k) {
      Eight theirP[3];
      Eight theirS[3];
      rows::pairsToLanes(pq, lower.column + k * laneCount, theirP, theirS);
      for (std::size_t i = 0; i < 3; ++i) {
        Eight v[3];
        for (std::size_t j = 0; j < 3; ++j) readVector(lower.value + ((9 * k + 3 * i) + j) * laneCount, v[j]);
        times[i] += (v[0] * theirP[0] + v[1] * theirP[1]) + v[2] * theirP[2];
        solved[i] += (v[0] * theirS[0] + v[1] * theirS[1]) + v[2] * theirS[2];
      }
    }
    Eight own[3];
    for (std::size_t i = 0; i < 3; ++i) readVector(p + slice * laneStride + i * laneCount, own[i]);
    Eight part[3];
    product<false>(diagonalOf(matrix, slice), own, part);
    for (std::size_t i = 0; i < 3; ++i) {
      times[i] += part[i];
      solved[i] = times[i] - solved[i];
      sum += __builtin_convertvector(own[i], EightDoubles) * __builtin_convertvector(times[i], EightDoubles);
    }
    product<false>(inverseOf(matrix, slice), solved, part);
    std::memcpy(q + slice * laneStride, times, sizeof times);
    std::memcpy(s + slice * laneStride, part, sizeof part);
    rows::storeSecond(part, pq + pairs);
  }
  writeVector(sum, dot);
}

CALOT_LANE_KERNEL void updatePairs(const Slices& matrix, float alpha, const float* p, const float* q, const float* s,
                                   float* x, float* r, float* y, float* z, double* dot) {
  const Eight by = {alpha, alpha, alpha, alpha, alpha, alpha, alpha, alpha};
  EightDoubles sum;
  readVector(dot, sum);
  for (std::size_t slice = 0; slice < matrix.count; ++slice) {
    Eight next[3];
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t at = slice * laneStride + i * laneCount;
      Eight step;
      Eight own;
      readVector(p + at, step);
      readVector(x + at, own);
      own += by * step;
      writeVector(own, x + at);
      readVector(q + at, step);
      readVector(r + at, own);
      own -= by * step;
      writeVector(own, r + at);
      readVector(s + at, step);
      readVector(y + at, next[i]);
      next[i] -= by * step;
    }
    Eight scaled[3];
    product<false>(diagonalOf(matrix, slice), next, scaled);
    for (std::size_t i = 0; i < 3; ++i) {
      sum += __builtin_convertvector(next[i], EightDoubles) * __builtin_convertvector(scaled[i], EightDoubles);
    }
    std::memcpy(y + slice * laneStride, next, sizeof next);
    std::memcpy(z + slice * laneStride, scaled, sizeof scaled);
  }
  writeVector(sum, dot);
}

}  // namespace calot::sweeps
