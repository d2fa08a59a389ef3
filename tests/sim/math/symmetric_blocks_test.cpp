// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/symmetric_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <Eigen/Dense>
#include <vector>

#include "sim/math/random.h"

namespace calot {
namespace {

Mat3 randomBlock(Random& random) {
  Mat3 m;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m(i, j) = 2.0 * random.uniform() - 1.0;
  }
  return m;
}

Vec3 randomVector(Random& random) {
  const double x = random.uniform();
  const double y = random.uniform();
  return {x, y, random.uniform()};
}

/// Springs between random rows, each of which is held weakly.
struct System {
  explicit System(std::size_t rows, std::size_t springs, double held, std::uint64_t seed)
      : matrix(rows), dense(Eigen::MatrixXd::Zero(3 * static_cast<int>(rows), 3 * static_cast<int>(rows))) {
    Random random(seed);
    const auto add = [&](std::size_t i, std::size_t j, const Mat3& block) {
      matrix.add(i, j, block);
      dense.block<3, 3>(3 * static_cast<int>(i), 3 * static_cast<int>(j)) += block;
      if (i != j) dense.block<3, 3>(3 * static_cast<int>(j), 3 * static_cast<int>(i)) += block.transpose();
    };
    for (std::size_t i = 0; i < rows; ++i) {
      if (held > 0.0) add(i, i, held * Mat3::Identity());
    }
    for (std::size_t s = 0; s < springs; ++s) {
      const std::size_t i =
          s < rows - 1 ? s + 1 : static_cast<std::size_t>(random.uniform() * static_cast<double>(rows));
      const std::size_t j =
          static_cast<std::size_t>(random.uniform() * static_cast<double>(s < rows - 1 ? s + 1 : rows));
      if (i == j) continue;
      const Mat3 a = randomBlock(random);
      const Mat3 k = a * a.transpose() + 0.1 * Mat3::Identity();
      add(i, i, k);
      add(j, j, k);
      add(i, j, -k);
    }
  }
  SymmetricBlocks matrix;
  Eigen::MatrixXd dense;
};

TEST(SymmetricBlocks, SolveAsADenseCholeskyDoes) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    System system(40, 100, 1e-3, seed);
    Random random(seed + 100);
    std::vector<Vec3> b;
    for (int i = 0; i < 40; ++i) b.push_back(randomVector(random));
    EXPECT_EQ(system.matrix.factor(), 0U);
    const std::vector<Vec3> x = system.matrix.solve(b);
    Eigen::VectorXd right(120);
    for (int i = 0; i < 40; ++i) right.segment<3>(3 * i) = b[static_cast<std::size_t>(i)];
    const Eigen::VectorXd dense = system.dense.llt().solve(right);
    const std::vector<Vec3> back = system.matrix.times(x);
    for (int i = 0; i < 40; ++i) {
      const auto n = static_cast<std::size_t>(i);
      EXPECT_LT((x[n] - dense.segment<3>(3 * i)).norm(), 1e-9 * dense.norm()) << seed;
      EXPECT_LT((back[n] - b[n]).norm(), 1e-11 * right.norm()) << seed;
    }
  }
}

TEST(SymmetricBlocks, TellHowManyUnknownsNothingHolds) {
  System system(30, 80, 0.0, 7);
  EXPECT_EQ(system.matrix.factor(), 3U) << "springs keep distances; all rows together may go anywhere";
  for (const Vec3& x : system.matrix.solve(std::vector<Vec3>(30, Vec3(1.0, 2.0, 3.0)))) EXPECT_TRUE(x.allFinite());
}

/// Sums run in an order that the system alone fixes.
TEST(SymmetricBlocks, GiveTheSameBitsAgain) {
  const std::vector<Vec3> b(50, Vec3(0.3, -1.0, 2.0));
  System first(50, 200, 1e-2, 3);
  System second(50, 200, 1e-2, 3);
  first.matrix.factor();
  second.matrix.factor();
  EXPECT_EQ(first.matrix.solve(b), second.matrix.solve(b));
}

}  // namespace
}  // namespace calot
