// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/camera/handle_tracker.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <random>

namespace calot::recorder {
namespace {

// Against the singular value decomposition: the orthonormal pair closest to a pair of axes is U V^T.
TEST(PlaneRotation, IsTheClosestOneToAnyTwoAxes) {
  std::mt19937_64 random(20261127);
  const auto number = [&] { return static_cast<double>(random() >> 11U) * 0x1p-52 - 1.0; };
  for (int round = 0; round < 500; ++round) {
    Eigen::MatrixXd axes(3, 2);
    for (Eigen::Index i = 0; i < 6; ++i) axes(i / 2, i % 2) = number();
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(axes, Eigen::ComputeThinU | Eigen::ComputeThinV);
    if (svd.singularValues()[1] < 0.01) continue;
    const Mat3 rotation = planeRotation(axes.col(0), axes.col(1));
    EXPECT_LT((rotation.leftCols<2>() - svd.matrixU() * svd.matrixV().transpose()).norm(), 1e-9) << round;
    EXPECT_LT((rotation * rotation.transpose() - Mat3::Identity()).norm(), 1e-9) << round;
    EXPECT_GT(rotation.determinant(), 0.0) << round;
  }
}

TEST(PlaneRotation, IsNotFiniteWhereTheAxesAreParallel) {
  EXPECT_FALSE(planeRotation(Vec3(1.0, 2.0, 3.0), Vec3(-2.0, -4.0, -6.0)).allFinite());
  EXPECT_FALSE(planeRotation(Vec3::Zero(), Vec3(0.0, 1.0, 0.0)).allFinite());
}

}  // namespace
}  // namespace calot::recorder
