// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solid/block_matrix.h"

#include <gtest/gtest.h>

#include <vector>

#include "sim/math/random.h"

namespace calot {
namespace {

Mat3 randomMatrix(Random& random) {
  Mat3 m;
  for (int i = 0; i < 9; ++i) m(i / 3, i % 3) = random.normal();
  return m;
}

/// Contact was decided on Eigen's own products before; recordings of this simulation version know their bits.
TEST(TurnedBlocks, HaveTheBitsOfThePlainSum) {
  SCOPED_TRACE("seed 51");
  Random random(51);
  for (const std::size_t countA : {1U, 3U, 12U}) {
    for (const std::size_t countC : {1U, 4U, 24U}) {
      std::vector<Mat3> a;
      std::vector<Mat3> c;
      std::vector<RotatedColumns> columnsA;
      std::vector<RotatedColumns> columnsC;
      for (std::size_t i = 0; i < countA; ++i) columnsA.push_back(columnsOf(a.emplace_back(randomMatrix(random))));
      for (std::size_t j = 0; j < countC; ++j) columnsC.push_back(columnsOf(c.emplace_back(randomMatrix(random))));
      std::vector<double> blocks;
      Mat3 wanted = Mat3::Zero();
      for (std::size_t i = 0; i < countA; ++i) {
        for (std::size_t j = 0; j < countC; ++j) {
          const Mat3 block = randomMatrix(random);
          for (int k = 0; k < 9; ++k) blocks.push_back(block(k / 3, k % 3));
          wanted += a[i] * block * c[j].transpose();
        }
      }
      blocks.push_back(0.0);
      EXPECT_EQ(sumOfRotated(columnsA, blocks, columnsC), wanted) << countA << " and " << countC << " nodes";
    }
  }
}

}  // namespace
}  // namespace calot
