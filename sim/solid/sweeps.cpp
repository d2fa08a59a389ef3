// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/sweeps.h"

#include <cstring>

#include "sim/math/vectors.h"

namespace calot::sweeps {

namespace {

using Four = FourFloats;
using Eight = EightFloats;

/// Two rows of four numbers after one another in each half.
CALOT_INLINE void join(const Four& low, const Four& high, Eight& out) {
  out = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}

/// Eight rows, which begin row[l] numbers from x, as three components of eight lanes.
CALOT_INLINE void turned(const float* x, const std::int32_t* row, Eight* out) {
  Four first[4];  // of rows 2 l and 2 l + 1: x x y y
  Four last[4];   // and z z and what fills up
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

/// Three components of eight lanes as eight rows: row l in half l / 4 of out[l % 4].
CALOT_INLINE void turnedBack(const Eight* lanes, Eight* out) {
  const Eight none{};
  const Eight low = __builtin_shufflevector(lanes[0], lanes[1], 0, 8, 1, 9, 4, 12, 5, 13);
  const Eight high = __builtin_shufflevector(lanes[0], lanes[1], 2, 10, 3, 11, 6, 14, 7, 15);
  const Eight lowLast = __builtin_shufflevector(lanes[2], none, 0, 8, 1, 9, 4, 12, 5, 13);
  const Eight highLast = __builtin_shufflevector(lanes[2], none, 2, 10, 3, 11, 6, 14, 7, 15);
  out[0] = __builtin_shufflevector(low, lowLast, 0, 1, 8, 9, 4, 5, 12, 13);
  out[1] = __builtin_shufflevector(low, lowLast, 2, 3, 10, 11, 6, 7, 14, 15);
  out[2] = __builtin_shufflevector(high, highLast, 0, 1, 8, 9, 4, 5, 12, 13);
  out[3] = __builtin_shufflevector(high, highLast, 2, 3, 10, 11, 6, 7, 14, 15);
}

/// Adds four numbers.
CALOT_INLINE void addTo(float* at, const Four& what) {
  Four own;
  readVector(at, own);
  own += what;
  writeVector(own, at);
}

/// Adds three components of eight lanes to rows, which begin row[l] numbers from x, in order of the lanes.
CALOT_INLINE void addRows(const Eight* lanes, const std::int32_t* row, float* x) {
  Eight rows[4];
  turnedBack(lanes, rows);
  for (std::size_t l = 0; l < 4; ++l) addTo(x + row[l], __builtin_shufflevector(rows[l], rows[l], 0, 1, 2, 3));
  for (std::size_t l = 0; l < 4; ++l) addTo(x + row[4 + l], __builtin_shufflevector(rows[l], rows[l], 4, 5, 6, 7));
}

/// Rows that follow one another.
constexpr std::int32_t inOrder[laneCount] = {0, 4, 8, 12, 16, 20, 24, 28};
static_assert(rowStride == 4 && laneCount == 8);

/// Keeps a slice's rows in the copy of the vector by rows.
CALOT_INLINE void keepRows(const Eight* lanes, float* rows) {
  Eight out[4];
  turnedBack(lanes, out);
  for (std::size_t l = 0; l < 4; ++l) {
    writeVector(Four(__builtin_shufflevector(out[l], out[l], 0, 1, 2, 3)), rows + inOrder[l]);
    writeVector(Four(__builtin_shufflevector(out[l], out[l], 4, 5, 6, 7)), rows + inOrder[4 + l]);
  }
}

/// One row of a block times d. @param value its first entry: of all lanes each its own, or (many) of one row for all
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

/// Of a row of a matrix of eight right-hand sides: where it begins.
CALOT_INLINE std::size_t manyAt(std::int32_t column) {
  return static_cast<std::size_t>(column) / rowStride * laneStride;
}

/// Where the rows of a slice begin in a vector by rows, or the row itself (many).
template <bool many>
CALOT_INLINE std::size_t rowsAt(std::size_t at) {
  return many ? at : at / 3 * rowStride;
}

template <bool many>
CALOT_INLINE void readRows(const float* rows, std::size_t at, Eight* out) {
  if constexpr (many) {
    std::memcpy(out, rows + at, 3 * sizeof *out);
  } else {
    turned(rows + rowsAt<many>(at), inOrder, out);
  }
}

template <bool many>
CALOT_INLINE void backwardLanes(const Blocks& lower, const float* inverse, const float* z, const float* beta, float* p,
                                float* t, float* u, std::size_t at) {
  Eight y[3];
  readRows<many>(u, at, y);
  Eight b;
  readVector(beta, b);
  for (std::size_t i = 0; i < 3; ++i) {
    Eight own;
    Eight before;
    readVector(z + at + i * laneCount, own);
    readVector(p + at + i * laneCount, before);
    own += b * before;
    writeVector(own, p + at + i * laneCount);
    y[i] = own - y[i];
  }
  Eight out[3];
  product<many>(inverse, y, out);
  std::memcpy(t + at, out, sizeof out);
  for (std::size_t k = 0; k < lower.width; ++k) {
    const std::int32_t* column = lower.column + k * laneCount;
    Eight part[3];
    for (std::size_t i = 0; i < 3; ++i) columnTimes<many>(lower.value + (9 * k + i) * laneCount, out, part[i]);
    if constexpr (many) {
      Eight own[3];
      float* place = u + manyAt(column[0]);
      std::memcpy(own, place, sizeof own);
      for (std::size_t i = 0; i < 3; ++i) own[i] += part[i];
      std::memcpy(place, own, sizeof own);
    } else {
      addRows(part, column, u);
    }
  }
}

template <bool many>
CALOT_INLINE void forwardLanes(const Blocks& lower, const float* inverse, const float* u, float* s, float* sRows,
                               const float* p, const float* t, double* dot, std::size_t at) {
  Eight y[3] = {};
  for (std::size_t k = 0; k < lower.width; ++k) {
    const std::int32_t* column = lower.column + k * laneCount;
    Eight d[3];
    if constexpr (many) {
      std::memcpy(d, s + manyAt(column[0]), sizeof d);
    } else {
      turned(sRows, column, d);
    }
    Eight part[3];
    product<many>(lower.value + k * 9 * laneCount, d, part);
    for (std::size_t i = 0; i < 3; ++i) y[i] += part[i];
  }
  Eight own[3];
  readRows<many>(u, at, own);
  for (std::size_t i = 0; i < 3; ++i) y[i] = own[i] - y[i];
  Eight out[3];
  product<many>(inverse, y, out);
  std::memcpy(s + at, out, sizeof out);
  if constexpr (!many) keepRows(out, sRows + rowsAt<many>(at));
  EightDoubles sum;
  readVector(dot, sum);
  for (std::size_t i = 0; i < 3; ++i) {
    Eight direction;
    Eight before;
    readVector(p + at + i * laneCount, direction);
    readVector(t + at + i * laneCount, before);
    sum += __builtin_convertvector(direction, EightDoubles) * __builtin_convertvector(before + out[i], EightDoubles);
  }
  writeVector(sum, dot);
}

template <bool many>
CALOT_INLINE void updateLanes(const float* diagonal, const float* alpha, const float* t, const float* s, float* x,
                              float* r, float* z, double* dot, std::size_t at) {
  Eight by;
  readVector(alpha, by);
  Eight next[3];
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t a = at + i * laneCount;
    Eight step;
    Eight rest;
    Eight own;
    readVector(t + a, step);
    readVector(s + a, rest);
    readVector(x + a, own);
    own += by * step;
    writeVector(own, x + a);
    readVector(r + a, own);
    next[i] = own - by * (step + rest);
  }
  Eight scaled[3];
  product<many>(diagonal, next, scaled);
  EightDoubles sum;
  readVector(dot, sum);
  for (std::size_t i = 0; i < 3; ++i) {
    sum += __builtin_convertvector(next[i], EightDoubles) * __builtin_convertvector(scaled[i], EightDoubles);
  }
  writeVector(sum, dot);
  std::memcpy(r + at, next, sizeof next);
  std::memcpy(z + at, scaled, sizeof scaled);
}

}  // namespace

CALOT_LANE_KERNEL void backward(const Blocks& lower, const float* inverse, const float* z, const float* beta, float* p,
                                float* t, float* u, std::size_t at) {
  backwardLanes<false>(lower, inverse, z, beta, p, t, u, at);
}

CALOT_LANE_KERNEL void backwardMany(const Blocks& lower, const float* inverse, const float* z, const float* beta,
                                    float* p, float* t, float* u, std::size_t at) {
  backwardLanes<true>(lower, inverse, z, beta, p, t, u, at);
}

CALOT_LANE_KERNEL void forward(const Blocks& lower, const float* inverse, const float* u, float* s, float* sRows,
                               const float* p, const float* t, double* dot, std::size_t at) {
  forwardLanes<false>(lower, inverse, u, s, sRows, p, t, dot, at);
}

CALOT_LANE_KERNEL void forwardMany(const Blocks& lower, const float* inverse, const float* u, float* s, const float* p,
                                   const float* t, double* dot, std::size_t at) {
  forwardLanes<true>(lower, inverse, u, s, nullptr, p, t, dot, at);
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
