// SPDX-License-Identifier: GPL-3.0-or-later
// Sweeps of two vectors at once.
#include "sim/solid/sweeps.h"

#include "sim/solid/block_matrix.h"

namespace calot::sweeps {

namespace {

using rows::addRows;
using rows::Eight;
using rows::storeRows;
using rows::toLanes;

/// Offset of a row in a vector of eight right-hand sides.
CALOT_INLINE std::size_t manyAt(std::int32_t column) {
  return static_cast<std::size_t>(column) / rowStride * laneStride;
}

/// Offset of a slice's rows in a vector stored by rows, or (many) of the row itself.
template <bool many>
CALOT_INLINE std::size_t rowsAt(std::size_t at) {
  return many ? at : at / 3 * rowStride;
}

template <bool many>
CALOT_INLINE void readRows(const float* rows, std::size_t at, Eight* out) {
  if constexpr (many) {
    readVectors<3>(rows + at, out);
  } else {
    rows::lanesOf(rows + rowsAt<many>(at), out);
  }
}

/// u += block^T t at the blocks' columns.
template <bool many>
CALOT_INLINE void propagate(const Blocks& lower, const Eight* t, float* u) {
  for (std::size_t k = 0; k < lower.width; ++k) {
    const std::int32_t* column = lower.column + k * laneCount;
    Eight part[3];
    for (std::size_t i = 0; i < 3; ++i) columnTimes<many>(lower.value + (9 * k + i) * laneCount, t, part[i]);
    if constexpr (many) {
      Eight own[3];
      float* place = u + manyAt(column[0]);
      readVectors<3>(place, own);
      for (std::size_t i = 0; i < 3; ++i) own[i] += part[i];
      writeVectors<3>(own, place);
    } else {
      addRows(part, column, u);
    }
  }
}

template <bool many>
CALOT_INLINE void backwardLanes(const Blocks& lower, const float* inverse, const float* z, const Eight& beta, float* p,
                                float* t, float* u, std::size_t at) {
  Eight y[3];
  readRows<many>(u, at, y);
  for (std::size_t i = 0; i < 3; ++i) {
    Eight own;
    Eight before;
    readVector(z + at + i * laneCount, own);
    readVector(p + at + i * laneCount, before);
    own += beta * before;
    writeVector(own, p + at + i * laneCount);
    y[i] = own - y[i];
  }
  Eight out[3];
  product<many>(inverse, y, out);
  writeVectors<3>(out, t + at);
  propagate<many>(lower, out, u);
}

/// out = inverse (u - sum of lower s). @param s by rows (many: it is the same)
template <bool many>
CALOT_INLINE void lowerLanes(const Blocks& lower, const float* inverse, const float* u, const float* s, std::size_t at,
                             Eight* out) {
  Eight y[3] = {};
  for (std::size_t k = 0; k < lower.width; ++k) {
    const std::int32_t* column = lower.column + k * laneCount;
    Eight d[3];
    if constexpr (many) {
      readVectors<3>(s + manyAt(column[0]), d);
    } else {
      toLanes(s, column, d);
    }
    Eight part[3];
    product<many>(lower.value + k * 9 * laneCount, d, part);
    for (std::size_t i = 0; i < 3; ++i) y[i] += part[i];
  }
  Eight own[3];
  readRows<many>(u, at, own);
  for (std::size_t i = 0; i < 3; ++i) y[i] = own[i] - y[i];
  product<many>(inverse, y, out);
}

template <bool many>
CALOT_INLINE void forwardLanes(const Blocks& lower, const float* inverse, const float* u, float* s, float* sRows,
                               const float* p, const float* t, LaneSums& sum, std::size_t at) {
  Eight out[3];
  lowerLanes<many>(lower, inverse, u, many ? s : sRows, at, out);
  writeVectors<3>(out, s + at);
  if constexpr (!many) storeRows(out, sRows + rowsAt<many>(at));
  for (std::size_t i = 0; i < 3; ++i) {
    Eight direction;
    Eight before;
    readVector(p + at + i * laneCount, direction);
    readVector(t + at + i * laneCount, before);
    sum.addProducts(direction, before + out[i]);
  }
}

template <bool many>
CALOT_INLINE void updateLanes(const float* diagonal, const Eight& by, const float* t, const float* s, float* x,
                              float* r, float* z, LaneSums& sum, std::size_t at) {
  Eight next[3];
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t a = at + i * laneCount;
    Eight step;
    Eight remainder;
    Eight own;
    readVector(t + a, step);
    readVector(s + a, remainder);
    readVector(x + a, own);
    own += by * step;
    writeVector(own, x + a);
    readVector(r + a, own);
    next[i] = own - by * (step + remainder);
  }
  Eight scaled[3];
  product<many>(diagonal, next, scaled);
  for (std::size_t i = 0; i < 3; ++i) {
    sum.addProducts(next[i], scaled[i]);
  }
  writeVectors<3>(next, r + at);
  writeVectors<3>(scaled, z + at);
}

/// Inverses of the diagonal blocks of lanes `from` to `from` + 3, in double.
CALOT_INLINE void invertFour(const float* in, std::size_t from, float* out) {
  FourDoubles a[3][3];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      FourFloats own;
      readVector(in + (3 * i + j) * laneCount + from, own);
      a[i][j] = __builtin_convertvector(own, FourDoubles);
    }
  }
  const FourDoubles c[9] = {a[1][1] * a[2][2] - a[1][2] * a[2][1], a[0][2] * a[2][1] - a[0][1] * a[2][2],
                            a[0][1] * a[1][2] - a[0][2] * a[1][1], a[1][2] * a[2][0] - a[1][0] * a[2][2],
                            a[0][0] * a[2][2] - a[0][2] * a[2][0], a[0][2] * a[1][0] - a[0][0] * a[1][2],
                            a[1][0] * a[2][1] - a[1][1] * a[2][0], a[0][1] * a[2][0] - a[0][0] * a[2][1],
                            a[0][0] * a[1][1] - a[0][1] * a[1][0]};
  const FourDoubles none{};
  const FourDoubles determinant = (a[0][0] * c[0] + a[0][1] * c[3]) + a[0][2] * c[6];
  const FourDoubles inverse = determinant == none ? none : 1.0 / determinant;
  for (std::size_t i = 0; i < 9; ++i) {
    writeVector(__builtin_convertvector(c[i] * inverse, FourFloats), out + i * laneCount + from);
  }
}

}  // namespace

CALOT_LANE_KERNEL void invertDiagonal(const Slices& matrix, float* inverse) {
  for (std::size_t s = 0; s < matrix.count; ++s) {
    for (const std::size_t from : {std::size_t{0}, std::size_t{4}})
      invertFour(diagonalOf(matrix, s), from, inverse + s * 9 * laneCount);
  }
}

CALOT_LANE_KERNEL void backward(const Slices& matrix, const float* z, float beta, float* p, float* t, float* u) {
  const Eight by = {beta, beta, beta, beta, beta, beta, beta, beta};
  for (std::size_t s = matrix.count; s-- > 0;) {
    Blocks lower;
    blocksOf(matrix, s, 0, lower);
    backwardLanes<false>(lower, inverseOf(matrix, s), z, by, p, t, u, s * laneStride);
  }
}

CALOT_LANE_KERNEL void backwardMany(const Slices& matrix, const float* z, const float* beta, float* p, float* t,
                                    float* u) {
  Eight by;
  readVector(beta, by);
  for (std::size_t r = matrix.count * laneCount; r-- > 0;) {
    const std::size_t lane = r % laneCount;
    Blocks lower;
    blocksOf(matrix, r / laneCount, lane, lower);
    backwardLanes<true>(lower, inverseOf(matrix, r / laneCount) + lane, z, by, p, t, u, r * laneStride);
  }
}

CALOT_LANE_KERNEL void forward(const Slices& matrix, const float* u, float* s, float* sRows, const float* p,
                               const float* t, double* dot) {
  LaneSums sum;
  sum.read(dot);
  for (std::size_t i = 0; i < matrix.count; ++i) {
    Blocks lower;
    blocksOf(matrix, i, 0, lower);
    forwardLanes<false>(lower, inverseOf(matrix, i), u, s, sRows, p, t, sum, i * laneStride);
  }
  sum.write(dot);
}

CALOT_LANE_KERNEL void forwardMany(const Slices& matrix, const float* u, float* s, const float* p, const float* t,
                                   double* dot) {
  LaneSums sum;
  sum.read(dot);
  for (std::size_t r = 0; r < matrix.count * laneCount; ++r) {
    const std::size_t lane = r % laneCount;
    Blocks lower;
    blocksOf(matrix, r / laneCount, lane, lower);
    forwardLanes<true>(lower, inverseOf(matrix, r / laneCount) + lane, u, s, nullptr, p, t, sum, r * laneStride);
  }
  sum.write(dot);
}

CALOT_LANE_KERNEL void update(const Slices& matrix, float alpha, const float* t, const float* s, float* x, float* r,
                              float* z, double* dot) {
  const Eight by = {alpha, alpha, alpha, alpha, alpha, alpha, alpha, alpha};
  LaneSums sum;
  sum.read(dot);
  for (std::size_t i = 0; i < matrix.count; ++i) {
    updateLanes<false>(diagonalOf(matrix, i), by, t, s, x, r, z, sum, i * laneStride);
  }
  sum.write(dot);
}

CALOT_LANE_KERNEL void updateMany(const Slices& matrix, const float* alpha, const float* t, const float* s, float* x,
                                  float* r, float* z, double* dot) {
  Eight by;
  readVector(alpha, by);
  LaneSums sum;
  sum.read(dot);
  for (std::size_t row = 0; row < matrix.count * laneCount; ++row) {
    updateLanes<true>(diagonalOf(matrix, row / laneCount) + row % laneCount, by, t, s, x, r, z, sum, row * laneStride);
  }
  sum.write(dot);
}

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
  LaneSums sum;
  sum.read(dot);
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
      sum.addProducts(own[i], times[i]);
    }
    product<false>(inverseOf(matrix, slice), solved, part);
    writeVectors<3>(times, q + slice * laneStride);
    writeVectors<3>(part, s + slice * laneStride);
    rows::storeSecond(part, pq + pairs);
  }
  sum.write(dot);
}

CALOT_LANE_KERNEL void updatePairs(const Slices& matrix, float alpha, const float* p, const float* q, const float* s,
                                   float* x, float* r, float* y, float* z, double* dot) {
  const Eight by = {alpha, alpha, alpha, alpha, alpha, alpha, alpha, alpha};
  LaneSums sum;
  sum.read(dot);
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
      sum.addProducts(next[i], scaled[i]);
    }
    writeVectors<3>(next, y + slice * laneStride);
    writeVectors<3>(scaled, z + slice * laneStride);
  }
  sum.write(dot);
}

}  // namespace calot::sweeps
