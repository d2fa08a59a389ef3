// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/rotated_blocks.h"

#include <cassert>

#include "sim/math/vectors.h"

namespace calot {

namespace {

/// Number k everywhere.
template <int k>
CALOT_INLINE void spread(const FourDoubles& v, FourDoubles& out) {
  out = __builtin_shufflevector(v, v, k, k, k, k);
}

/// @param out three rows of four numbers
CALOT_LANE_KERNEL void sumRows(const double* a, std::size_t countA, const double* block, const double* c,
                               std::size_t countC, double* out) {
  FourDoubles sum[3] = {};
  for (std::size_t i = 0; i < countA; ++i) {
    const double* rotation = a + 12 * i;
    for (std::size_t j = 0; j < countC; ++j, block += 9) {
      FourDoubles row[3];
      FourDoubles column[3];
      for (std::size_t k = 0; k < 3; ++k) {
        readVector(block + 3 * k, row[k]);
        readVector(c + 12 * j + 4 * k, column[k]);
      }
      for (std::size_t r = 0; r < 3; ++r) {
        const FourDoubles once = rotation[r] * row[0] + (rotation[4 + r] * row[1] + rotation[8 + r] * row[2]);
        FourDoubles x;
        FourDoubles y;
        FourDoubles z;
        spread<0>(once, x);
        spread<1>(once, y);
        spread<2>(once, z);
        sum[r] += x * column[0] + (y * column[1] + z * column[2]);
      }
    }
  }
  for (std::size_t r = 0; r < 3; ++r) writeVector(sum[r], out + 4 * r);
}

}  // namespace

RotatedColumns columnsOf(const Mat3& matrix) {
  RotatedColumns out{};
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t r = 0; r < 3; ++r) out[4 * k + r] = matrix(static_cast<int>(r), static_cast<int>(k));
  }
  return out;
}

Mat3 sumOfRotated(std::span<const RotatedColumns> a, std::span<const double> block, std::span<const RotatedColumns> c) {
  assert(block.size() == 9 * a.size() * c.size() + 1);
  double rows[12];
  sumRows(a.data()->data(), a.size(), block.data(), c.data()->data(), c.size(), rows);
  Mat3 out;
  for (int r = 0; r < 3; ++r) {
    for (int k = 0; k < 3; ++k) out(r, k) = rows[4 * r + k];
  }
  return out;
}

}  // namespace calot
