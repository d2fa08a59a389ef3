// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/instruments/port.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/instruments/shaft.h"
#include "sim/math/random.h"

namespace calot {
namespace {

Vec3 randomVector(Random& random) { return {random.normal(), random.normal(), random.normal()}; }

Quat randomTurn(Random& random) {
  Quat q(random.normal(), random.normal(), random.normal(), random.normal());
  q.normalize();
  return q;
}

TEST(Port, TheShaftPassesThroughThePortAndKeepsItsRoll) {
  SCOPED_TRACE("seed 41");
  Random random(41);
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3 port = 0.1 * randomVector(random);
    const Vec3 tip = port + 0.1 * randomVector(random);
    if ((tip - port).norm() < leastInsertion) continue;
    const Quat hand = randomTurn(random);
    const Pose pose = throughPort(port, tip, hand, Vec3::UnitZ());
    EXPECT_EQ(pose.position, tip) << "a reachable tip is not moved";
    EXPECT_NEAR(pose.orientation.norm(), 1.0, 1e-14);
    const Mat3 r = pose.orientation.toRotationMatrix();
    const Vec3 axis = (tip - port).normalized();
    EXPECT_LT((r.col(2) - axis).norm(), 1e-12) << "z points along the shaft, away from the port";
    // x lies in the plane of the axis and the hand's x, on the hand's side: nothing is turned about the shaft.
    const Vec3 x = hand.toRotationMatrix().col(0);
    EXPECT_NEAR(r.col(0).dot(axis.cross(x)), 0.0, 1e-12);
    EXPECT_GT(r.col(0).dot(x), 0.0);
    // A pose that is possible already is left as it is.
    const Pose again = throughPort(port, tip, pose.orientation, Vec3::UnitZ());
    EXPECT_LT(again.orientation.angularDistance(pose.orientation), 1e-7);
  }
}

TEST(Port, RollAboutTheShaftIsTheHandsOwn) {
  const Vec3 port(0.0, 0.0, 0.1);
  const Vec3 tip(0.0, 0.0, 0.0);
  const Quat start = alongAxis(Vec3(0.0, 0.0, -1.0), Vec3::UnitX());
  for (const double angle : {0.3, 1.5, 2.8, -2.0}) {
    const Quat rolled = start * Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ()));
    EXPECT_LT(throughPort(port, tip, rolled, Vec3::UnitZ()).orientation.angularDistance(rolled), 1e-7) << angle;
  }
}

TEST(Port, ATipAtThePortIsHeldInside) {
  const Vec3 port(0.02, -0.01, 0.1);
  const Vec3 previous = Vec3(1.0, -2.0, -2.0) / 3.0;
  const Pose at = throughPort(port, port, Quat::Identity(), previous);
  EXPECT_LT((at.position - (port + leastInsertion * previous)).norm(), 1e-15) << "along the previous direction";
  EXPECT_LT((at.orientation * Vec3::UnitZ() - previous).norm(), 1e-12);
  const Vec3 near = port + 0.004 * Vec3::UnitY();
  const Pose pushed = throughPort(port, near, Quat::Identity(), previous);
  EXPECT_LT((pushed.position - (port + leastInsertion * Vec3::UnitY())).norm(), 1e-15) << "along its own direction";
  const Vec3 enough = port + leastInsertion * Vec3::UnitY();
  EXPECT_LT((throughPort(port, enough, Quat::Identity(), previous).position - enough).norm(), 1e-15);
}

TEST(Port, RollAlongTheAxisTakesAFixedPerpendicular) {
  SCOPED_TRACE("seed 42");
  Random random(42);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 axis = trial < 3 ? Vec3(Vec3::Unit(trial)) : Vec3(randomVector(random).normalized());
    for (const double sign : {1.0, -1.0}) {
      const Quat q = alongAxis(axis, sign * axis);
      ASSERT_TRUE(q.coeffs().allFinite());
      EXPECT_NEAR(q.norm(), 1.0, 1e-14);
      EXPECT_LT((q * Vec3::UnitZ() - axis).norm(), 1e-12);
      EXPECT_EQ(q.coeffs(), alongAxis(axis, -sign * axis).coeffs());
    }
  }
}

/// A point of the pivoting shaft keeps its distance from the tip; its motion by finite differences of the tip's.
TEST(Port, ShaftTransposeIsTheTransposedJacobian) {
  SCOPED_TRACE("seed 43");
  Random random(43);
  for (int trial = 0; trial < 100; ++trial) {
    const Vec3 port = 0.1 * randomVector(random);
    const double length = random.uniform(0.02, 0.25);
    const Vec3 axis = randomVector(random).normalized();
    const Vec3 tip = port + length * axis;
    const double s = random.uniform() * length;
    const auto point = [&](const Vec3& at) -> Vec3 { return at - (length - s) * (at - port).normalized(); };
    Mat3 jacobian;
    constexpr double h = 1e-6;
    for (int k = 0; k < 3; ++k)
      jacobian.col(k) = (point(tip + h * Vec3::Unit(k)) - point(tip - h * Vec3::Unit(k))) / (2.0 * h);
    const Vec3 force = randomVector(random);
    EXPECT_LT((shaftTranspose(axis, s, length, force) - jacobian.transpose() * force).norm(), 1e-7 * force.norm());
  }
  // At the tip nothing is levered, at the port only the pull along the shaft is felt.
  const Vec3 force(1.0, 2.0, 3.0);
  EXPECT_EQ(shaftTranspose(Vec3::UnitZ(), 0.1, 0.1, force), force);
  EXPECT_EQ(shaftTranspose(Vec3::UnitZ(), 0.0, 0.1, force), Vec3(0.0, 0.0, 3.0));
}

/// Conservative advancement and the reduction to the tip both stand on this: no point moves farther than the tip.
TEST(Port, NoPointOfTheShaftMovesFartherThanTheTip) {
  SCOPED_TRACE("seed 44");
  Random random(44);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 axis = randomVector(random).normalized();
    const double length = random.uniform(0.02, 0.25);
    const Vec3 move = randomVector(random);
    EXPECT_LE(shaftTranspose(axis, random.uniform() * length, length, move).norm(), move.norm() * (1.0 + 1e-12));
  }
}

TEST(Shaft, PiecesCoverItFromTipToPort) {
  SCOPED_TRACE("seed 45");
  Random random(45);
  for (int trial = 0; trial < 300; ++trial) {
    const Vec3 port = 0.1 * randomVector(random);
    const double length = trial == 0 ? 1.5 : random.uniform(0.001, 0.4);
    const Vec3 tip = port + length * randomVector(random).normalized();
    const Shaft shaft(port, tip, 0.0025);
    ASSERT_GE(shaft.pieces(), 1U);
    ASSERT_LE(shaft.pieces(), Shaft::mostPieces);
    const double cap = std::min(0.0025, length);
    EXPECT_NEAR((shaft.piece(0).first - tip).norm(), cap, 1e-12) << "the cap ends at the tip";
    for (std::size_t k = 0; k + 1 < shaft.pieces(); ++k) {
      EXPECT_LT((shaft.piece(k).second - shaft.piece(k + 1).first).norm(), 1e-12);
      EXPECT_NEAR((shaft.piece(k).second - shaft.piece(k).first).norm(), Shaft::pieceLength, 1e-12);
    }
    EXPECT_LT((shaft.piece(shaft.pieces() - 1).second - port).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace calot
